// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "daemon/common/base/random.h"
#include "daemon/common/base/sha256.h"
#include "daemon/pipeline/perception.h"
#include "daemon/pipeline/timeline.h"
#include "daemon/v2v/gps_bias/gps_bias.h"
#include "tests/support/synthetic_drive.h"

namespace v2vouch {
namespace {

using testing::DriveStart;
using testing::MakeInputs;
using testing::SyntheticCar;
using testing::SyntheticDrive;

// Five lanes of cars ahead and behind that keep pace with the ego; every third one speaks.
SyntheticDrive DenseTraffic(int cars, double duration_s) {
  SyntheticDrive drive;
  drive.duration_s = duration_s;
  for (int i = 0; i < cars; ++i) {
    const int lane = i % 5;
    const int row = i / 5;
    drive.cars.push_back({.x_m = 14.0 + 13.0 * (row % 2 == 0 ? row / 2 : -(row / 2) - 3),
                          .y_m = 3.5 * (lane - 2),
                          .speed_mps = 8.0 + 0.3 * (lane - 2),
                          .sender = i % 3 == 0 ? static_cast<SenderId>(100 + i) : 0});
  }
  return drive;
}

void Run(const std::vector<Input>& inputs) {
  Perception perception(PerceptionConfig{}, std::make_unique<GpsBias>(GpsBiasConfig{}));
  Outputs outputs;
  for (const Input& input : inputs) {
    perception.Step(input, outputs);
    benchmark::DoNotOptimize(outputs.local.tracks.data());
  }
}

// Four seconds of driving among ten cars, every input on time. Can afford 13 ms, which is 300 x
// real time, the target of offline replay.
void BM_DriveOnTime(benchmark::State& state) {
  const std::vector<Input> inputs = MakeInputs(DenseTraffic(10, 4.0));
  for (auto _ : state) Run(inputs);
  state.counters["x_realtime"] =
      benchmark::Counter(4.0, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(BM_DriveOnTime)->Unit(benchmark::kMillisecond);

// The same with every picture 0.1 s late, as behind a neural network: each one has some ten frames
// of radar re-run. Can afford three times as much, 40 ms.
void BM_DriveWithLatePictures(benchmark::State& state) {
  std::vector<Input> inputs = MakeInputs(DenseTraffic(10, 4.0));
  const auto arrival = [](const Input& input) {
    const bool is_late = std::holds_alternative<CameraDetections>(input);
    return HeaderOf(input).stamp + FromSeconds(is_late ? 0.1 : 0.0);
  };
  std::stable_sort(inputs.begin(), inputs.end(),
                   [&](const Input& a, const Input& b) { return arrival(a) < arrival(b); });
  for (auto _ : state) Run(inputs);
  state.counters["x_realtime"] =
      benchmark::Counter(4.0, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(BM_DriveWithLatePictures)->Unit(benchmark::kMillisecond);

// What a late picture costs beside the frames it has re-run. Every picture of a drive among ten
// cars comes as many milliseconds late as the argument says. Counters, means over pictures: `reran`
// frames after it, `late_us` its whole step, `step_us` a frame's step in order. Can afford
// (reran + 2) steps (restore, itself, what came since): `of_allowed` <= 1.
void BM_LatePicture(benchmark::State& state) {
  const double delay_s = 1e-3 * static_cast<double>(state.range(0));
  std::vector<Input> inputs = MakeInputs(DenseTraffic(10, 4.0));
  const auto arrival = [&](const Input& input) {
    const bool is_late = std::holds_alternative<CameraDetections>(input);
    return HeaderOf(input).stamp + FromSeconds(is_late ? delay_s : 0.0);
  };
  std::stable_sort(inputs.begin(), inputs.end(),
                   [&](const Input& a, const Input& b) { return arrival(a) < arrival(b); });
  double step_s = 0.0, late_s = 0.0, allowed_s = 0.0;
  double steps = 0.0, pictures = 0.0, reran = 0.0;
  for (auto _ : state) {
    Perception perception(PerceptionConfig{}, std::make_unique<GpsBias>(GpsBiasConfig{}));
    Outputs outputs;
    std::vector<Timestamp> frames;
    double run_steps = 0.0, run_step_s = 0.0, run_late_s = 0.0, run_pictures = 0.0, run_reran = 0.0;
    for (const Input& input : inputs) {
      const bool is_picture = std::holds_alternative<CameraDetections>(input);
      const bool is_scan = std::holds_alternative<RadarScan>(input);
      const Timestamp stamp = HeaderOf(input).stamp;
      const auto before = std::chrono::steady_clock::now();
      perception.Step(input, outputs);
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
      // The tracks must be there before anything is worth measuring.
      const bool is_warm = stamp > DriveStart() + FromSeconds(1.5);
      if (is_warm && is_picture) {
        run_late_s += took.count();
        run_pictures += 1.0;
        run_reran += static_cast<double>(std::count_if(
            frames.begin(), frames.end(), [&](Timestamp other) { return other > stamp; }));
      } else if (is_warm && is_scan) {
        run_step_s += took.count();
        run_steps += 1.0;
      }
      if (is_picture || is_scan) frames.push_back(stamp);
    }
    allowed_s += (run_reran + 2.0 * run_pictures) * run_step_s / run_steps;
    step_s += run_step_s;
    late_s += run_late_s;
    steps += run_steps;
    pictures += run_pictures;
    reran += run_reran;
  }
  state.counters["reran"] = reran / pictures;
  state.counters["step_us"] = 1e6 * step_s / steps;
  state.counters["late_us"] = 1e6 * late_s / pictures;
  state.counters["of_allowed"] = late_s / allowed_s;
}
BENCHMARK(BM_LatePicture)->Arg(50)->Arg(100)->Arg(300)->Unit(benchmark::kMillisecond);

// One solve of the GPS biases of so many senders, each with a residual in every second of the
// window: what one step of each second of message time takes on top. Senders are vehicles in
// PRIORITY, a handful mostly; can afford 50 ms at the table's size, one frame's period.
void BM_GpsBiasSolve(benchmark::State& state) {
  GpsBiasConfig config;
  GpsBias bias(config);
  Random random(1);
  const auto senders = static_cast<SenderId>(state.range(0));
  std::int64_t second = 0;
  const auto feed = [&] {
    for (SenderId sender = 1; sender <= senders; ++sender) {
      const Eigen::Vector2d noise(random.Normal(0.0, 0.5), random.Normal(0.0, 0.5));
      bias.Observe({sender, DriveStart() + FromSeconds(static_cast<double>(second) + 0.5), noise,
                    0.25 * Eigen::Matrix2d::Identity()});
    }
    ++second;
  };
  for (int i = 0; i < 60; ++i) feed();
  for (auto _ : state) {
    state.PauseTiming();
    feed();
    state.ResumeTiming();
    bias.AdvanceTo(DriveStart() + FromSeconds(static_cast<double>(second)));
  }
}
BENCHMARK(BM_GpsBiasSolve)->Arg(1)->Arg(8)->Arg(32)->Unit(benchmark::kMillisecond);

// LOCAL after two seconds of a drive, and the inputs of the half second that follows.
struct Warm {
  explicit Warm(int cars) : local(LocalConfig{}) {
    for (const Input& input : MakeInputs(DenseTraffic(cars, 2.5))) {
      if (HeaderOf(input).stamp < DriveStart() + FromSeconds(2.0)) {
        Step(local, input);
      } else {
        rest.push_back(input);
      }
    }
  }

  int Step(LocalPerception& perception, const Input& input) {
    RadarPreparation prepared;
    if (const auto* motion = std::get_if<EgoMotion>(&input)) {
      perception.OnEgoMotion(*motion);
    } else if (const auto* scan = std::get_if<RadarScan>(&input)) {
      return perception.OnRadarScan(*scan, prepared, frame) ? 0 : 1;
    } else if (const auto* boxes = std::get_if<CameraDetections>(&input)) {
      return perception.OnCameraDetections(*boxes, frame) ? 0 : 1;
    }
    return 0;
  }

  LocalPerception local;
  LocalFrame frame;
  std::vector<Input> rest;
};

// One frame of LOCAL, odometry included. Can afford 100 us among 10 cars, 500 us among 50.
void BM_LocalFrame(benchmark::State& state) {
  Warm warm(static_cast<int>(state.range(0)));
  int frames = 0;
  LocalPerception local = warm.local;
  std::size_t next = 0;
  for (auto _ : state) {
    for (bool is_frame = false; !is_frame; ++next) {
      if (next == warm.rest.size()) {
        local = warm.local;
        next = 0;
      }
      is_frame = warm.Step(local, warm.rest[next]) > 0;
    }
    ++frames;
  }
  state.counters["tracks"] = static_cast<double>(warm.frame.tracks.size());
  state.SetItemsProcessed(frames);
}
BENCHMARK(BM_LocalFrame)->Arg(10)->Arg(50)->Unit(benchmark::kMicrosecond);

// LOCAL's part of a checkpoint. A whole one can afford 20 us with 50 tracks.
void BM_LocalCheckpoint(benchmark::State& state) {
  const Warm warm(static_cast<int>(state.range(0)));
  LocalPerception copy = warm.local;
  for (auto _ : state) {
    copy = warm.local;
    benchmark::DoNotOptimize(copy);
  }
}
BENCHMARK(BM_LocalCheckpoint)->Arg(10)->Arg(50)->Unit(benchmark::kMicrosecond);

// The running digest over 7 kB, a list of ten tracks. Can afford 10 us with the SHA extensions of
// the processor, 40 us without.
void BM_Digest(benchmark::State& state) {
  const std::vector<std::uint8_t> list(7000, 0x5a);
  Sha256 digest;
  for (auto _ : state) digest.Add(list);
  benchmark::DoNotOptimize(digest.Hex());
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(list.size()));
}
BENCHMARK(BM_Digest)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace v2vouch
