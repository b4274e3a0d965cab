// SPDX-License-Identifier: Apache-2.0
// What a radio flood costs. One drive among ten cars, of which every third speaks, is stepped with
// and without each flood; printed are the processor time of an own frame's step (median, p99) with
// its ratio to the same frames without the flood, the time of a BSM's step (mean, p99), how much of
// one core a second of input takes, and what became of the senders.
//
// The flood begins after ten seconds, when the senders that can be validated are.
//
//     flood_study [SECONDS]            every kind of flood; default 20
//     flood_study [SECONDS] capacity   up to 100 000 messages a second instead: how many one core
//                                      takes before the frames' p99 exceeds 5 ms or the core is
//                                      full
//
// ctest only sees that it runs.
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "daemon/pipeline/perception.h"
#include "daemon/v2v/gps_bias/gps_bias.h"
#include "tests/support/flood.h"

namespace v2vouch {
namespace {

using testing::FloodKind;

constexpr double kFlood_s = 10.0;

struct Case {
  const char* name;
  FloodKind kind;
  double rate_hz;
};

constexpr Case kCases[] = {
    {"no flood", FloodKind::kNone, 0.0},
    {"refused content", FloodKind::kRefused, 5000.0},
    {"random identities", FloodKind::kRandom, 5000.0},
    {"Sybils by a track", FloodKind::kSybils, 5000.0},
    {"one id, 4 x", FloodKind::kOneId, 40.0},
    {"one id, 40 x", FloodKind::kOneId, 400.0},
    {"one id, 1000 x", FloodKind::kOneId, 10000.0},
    {"1000 neighbours", FloodKind::kCrowd, 10000.0},
};

testing::SyntheticDrive Traffic(double duration_s) {
  testing::SyntheticDrive drive;
  drive.duration_s = duration_s;
  for (int i = 0; i < 10; ++i) {
    const int lane = i % 5;
    const int row = i / 5;
    drive.cars.push_back({.x_m = 14.0 + 13.0 * row,
                          .y_m = 3.5 * (lane - 2),
                          .speed_mps = 8.0 + 0.3 * (lane - 2),
                          .sender = i % 3 == 0 ? static_cast<SenderId>(100 + i) : 0});
  }
  return drive;
}

// Of this thread alone: what else the machine does costs nobody anything here.
double CpuTime_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

double Quantile(std::vector<double>& values, double q) {
  if (values.empty()) return 0.0;
  const auto at =
      std::min(values.size() - 1, static_cast<std::size_t>(q * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

struct Cost {
  double frame_median_us = 0.0;
  double frame_p99_us = 0.0;
};

Cost Measure(const Case& c, double duration_s, bool has_late_pictures, const Cost& base) {
  const testing::SyntheticDrive drive = Traffic(duration_s);
  std::vector<Input> inputs = testing::Merged(testing::MakeInputs(drive),
                                              testing::FloodOf(c.kind, c.rate_hz, kFlood_s, drive));
  std::ranges::stable_sort(inputs, {}, [&](const Input& input) {
    const bool is_late = has_late_pictures && std::holds_alternative<CameraDetections>(input);
    return HeaderOf(input).stamp + FromSeconds(is_late ? 0.1 : 0.0);
  });
  Perception perception(PerceptionConfig{}, std::make_unique<GpsBias>(GpsBiasConfig{}));
  Outputs outputs;
  std::vector<double> frames_us;
  std::vector<double> bsms_us;
  double total_us = 0.0;
  std::size_t most_priority = 0;
  std::size_t least_priority = 1000;
  std::size_t priority = 0;
  const Timestamp from = testing::DriveStart() + FromSeconds(kFlood_s + 0.5);
  for (const Input& input : inputs) {
    const double before_us = CpuTime_us();
    perception.Step(input, outputs);
    const double took_us = CpuTime_us() - before_us;
    if (outputs.has_lists) priority = outputs.priority.tracks.size();
    if (HeaderOf(input).stamp < from) continue;
    if (outputs.has_lists) {
      most_priority = std::max(most_priority, priority);
      least_priority = std::min(least_priority, priority);
    }
    total_us += took_us;
    if (std::holds_alternative<Bsm>(input)) {
      bsms_us.push_back(took_us);
    } else if (std::holds_alternative<RadarScan>(input) ||
               std::holds_alternative<CameraDetections>(input)) {
      frames_us.push_back(took_us);
    }
  }
  double bsm_mean = 0.0;
  for (const double us : bsms_us) bsm_mean += us / static_cast<double>(bsms_us.size());
  const Cost cost{Quantile(frames_us, 0.5), Quantile(frames_us, 0.99)};
  std::printf(
      "%-19s %7.0f %7.0f us %7.0f us  x %4.2f %4.2f   %6.1f us %6.1f us   %5.1f %%  %4d %4zu "
      "%4zu\n",
      c.name, c.rate_hz, cost.frame_median_us, cost.frame_p99_us,
      base.frame_median_us > 0.0 ? cost.frame_median_us / base.frame_median_us : 1.0,
      base.frame_p99_us > 0.0 ? cost.frame_p99_us / base.frame_p99_us : 1.0, bsm_mean,
      Quantile(bsms_us, 0.99), 1e-4 * total_us / (duration_s - kFlood_s - 0.5),
      perception.sender_count(), priority, most_priority);
  return cost;
}

}  // namespace
}  // namespace v2vouch

int main(int argc, char** argv) {
  using v2vouch::testing::FloodKind;
  const double duration_s = argc > 1 ? std::atof(argv[1]) : 20.0;
  const bool is_capacity = argc == 3 && std::string(argv[2]) == "capacity";
  if (duration_s < 11.0 || duration_s > 600.0 || argc > (is_capacity ? 3 : 2)) {
    std::fprintf(stderr, "usage: flood_study [SECONDS [capacity]], SECONDS 11 to 600\n");
    return 2;
  }
  std::vector<v2vouch::Case> cases(std::begin(v2vouch::kCases), std::end(v2vouch::kCases));
  if (is_capacity) {
    cases.resize(1);
    for (const double rate_hz : {5e3, 15e3, 30e3, 100e3}) {
      cases.push_back({"refused content", FloodKind::kRefused, rate_hz});
      cases.push_back({"random identities", FloodKind::kRandom, rate_hz});
      cases.push_back({"Sybils by a track", FloodKind::kSybils, rate_hz});
      cases.push_back({"neighbours", FloodKind::kCrowd, rate_hz});
    }
  }
  for (const bool has_late_pictures : {false, true}) {
    std::printf("%s\n%-19s %7s %10s %10s  %11s   %9s %9s   %7s  %s\n",
                has_late_pictures ? "\npictures 0.1 s late" : "all on time", "flood", "msg/s",
                "frame p50", "frame p99", "ratio", "BSM mean", "BSM p99", "core",
                "senders, PRIORITY least and most");
    v2vouch::Cost base;
    for (const v2vouch::Case& c : cases) {
      const v2vouch::Cost cost = v2vouch::Measure(c, duration_s, has_late_pictures, base);
      if (c.kind == FloodKind::kNone) base = cost;
    }
  }
  return 0;
}
