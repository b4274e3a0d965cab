// SPDX-License-Identifier: Apache-2.0
// What sensors cost that fill every message: 1024 returns in each scan of every radar, 512 boxes in
// each picture. Real time allows 16 ms per scan of three radars at 20 Hz. Counters: `frame_us` mean
// processor time of such a frame's step (the rest of the drive is not counted), `tracks` mean of
// LOCAL, `x_realtime`.
#include <benchmark/benchmark.h>
#include <time.h>

#include <memory>
#include <variant>
#include <vector>

#include "daemon/pipeline/perception.h"
#include "daemon/v2v/gps_bias/gps_bias.h"
#include "tests/support/full_radar.h"

namespace v2vouch {
namespace {

using testing::FullKind;

constexpr double kDuration_s = 3.0;
constexpr double kWarm_s = 1.0;

testing::SyntheticDrive Traffic() {
  testing::SyntheticDrive drive;
  drive.duration_s = kDuration_s;
  for (int i = 0; i < 10; ++i) {
    drive.cars.push_back({.x_m = 14.0 + 13.0 * (i / 5),
                          .y_m = 3.5 * (i % 5 - 2),
                          .speed_mps = 8.0 + 0.3 * (i % 5 - 2),
                          .sender = i % 3 == 0 ? static_cast<SenderId>(100 + i) : 0});
  }
  return drive;
}

// Of this thread alone.
double CpuTime_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

void Measure(benchmark::State& state, const std::vector<Input>& inputs,
             bool (*is_full)(const Input& input)) {
  const Timestamp warm = testing::DriveStart() + FromSeconds(kWarm_s);
  double frames_us = 0.0, total_us = 0.0, frames = 0.0;
  for (auto _ : state) {
    Perception perception(PerceptionConfig{}, std::make_unique<GpsBias>(GpsBiasConfig{}));
    Outputs outputs;
    for (const Input& input : inputs) {
      const double before_us = CpuTime_us();
      perception.Step(input, outputs);
      const double took_us = CpuTime_us() - before_us;
      if (HeaderOf(input).stamp < warm) continue;
      total_us += took_us;
      if (!is_full(input)) continue;
      frames_us += took_us;
      frames += 1.0;
    }
  }
  state.counters["frame_us"] = frames_us / frames;
  state.counters["x_realtime"] =
      1e6 * (kDuration_s - kWarm_s) * static_cast<double>(state.iterations()) / total_us;
}

void BM_FullRadars(benchmark::State& state) {
  Measure(state, WithFullRadars(Traffic(), static_cast<FullKind>(state.range(0))),
          [](const Input& input) { return std::holds_alternative<RadarScan>(input); });
}
BENCHMARK(BM_FullRadars)
    ->Arg(static_cast<int>(FullKind::kMoving))
    ->Arg(static_cast<int>(FullKind::kRing))
    ->Arg(static_cast<int>(FullKind::kStanding))
    ->Unit(benchmark::kMillisecond);

void BM_FullCameras(benchmark::State& state) {
  Measure(state, WithFullCameras(Traffic()),
          [](const Input& input) { return std::holds_alternative<CameraDetections>(input); });
}
BENCHMARK(BM_FullCameras)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace v2vouch
