// SPDX-License-Identifier: Apache-2.0
#include "sim/bench/bench.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::bench {
namespace {

Recording Traffic(int vehicles, std::uint64_t seed, double curvature_per_m = 0.0) {
  return GenerateTraffic({.vehicles = vehicles, .seed = seed, .curvature_per_m = curvature_per_m});
}

TEST(Bench, NoFalseTrackNoSwitchNoMissAndBetterThanTheDetections) {
  const BenchFigures f = RunBench(Traffic(50, 1), {});
  EXPECT_EQ(f.frames, 200);
  EXPECT_EQ(f.truths, 200 * 50);
  EXPECT_EQ(f.missed, 0);
  EXPECT_EQ(f.false_tracks, 0);
  EXPECT_EQ(f.switches, 0);
  // Single detections have 0.71 m; the published reference filter has 0.28 m.
  EXPECT_LT(f.rmse_m(), 0.28);
  EXPECT_LT(f.gospa_mean(), 1.98);
}

TEST(Bench, BendsCostLittle) {
  const BenchFigures f = RunBench(Traffic(50, 2, 0.01), {});
  EXPECT_EQ(f.missed, 0);
  EXPECT_EQ(f.switches, 0);
  EXPECT_LT(f.rmse_m(), 0.28);
}

// Turning the world turns the answer and changes nothing else: same tracks, same detections given
// to them, same distance from the truth.
TEST(Bench, TheDirectionOfTheRoadDoesNotMatter) {
  const Recording straight = Traffic(50, 3);
  std::vector<Snapshot> expected;
  const BenchFigures reference = RunBench(straight, {}, {}, &expected);
  for (const double angle : {0.5 * kPi, kPi, -0.5 * kPi, 0.25 * kPi, 0.6, -2.3, kPi - 1e-4}) {
    std::vector<Snapshot> turned;
    const BenchFigures figures = RunBench(Rotated(straight, angle), {}, {}, &turned);
    EXPECT_NEAR(figures.gospa_mean(), reference.gospa_mean(), 1e-6) << angle;
    ASSERT_EQ(turned.size(), expected.size());
    for (std::size_t k = 0; k < turned.size(); ++k) {
      ASSERT_EQ(turned[k].ids, expected[k].ids) << "angle " << angle << " frame " << k;
      ASSERT_EQ(turned[k].poses, expected[k].poses) << "angle " << angle << " frame " << k;
    }
  }
}

// In another tracker a wider gate brought 1185 identity switches.
TEST(Bench, AWiderGateNeverWorsensSeparableTraffic) {
  const Recording recording = Traffic(50, 4);
  for (const double gate : {0.99, 0.9999, 0.999999, 0.999999999}) {
    const BenchFigures f = RunBench(recording, {.gate_probability = gate});
    EXPECT_EQ(f.switches, 0) << gate;
    EXPECT_EQ(f.false_tracks, 0) << gate;
    EXPECT_LT(f.rmse_m(), 0.28) << gate;
  }
}

TEST(Bench, WithoutClutterAndMissesEveryFrameIsWhole) {
  TrafficSpec spec{.vehicles = 20, .seed = 5, .detection_probability = 1.0, .clutter_share = 0.0};
  const BenchFigures f = RunBench(GenerateTraffic(spec), {});
  EXPECT_EQ(f.detections, 220 * 20);
  EXPECT_EQ(f.missed + f.false_states + f.switches, 0);
}

TEST(Bench, EmptyFramesAreHarmless) {
  Recording recording(30);
  for (int k = 0; k < 30; ++k) {
    recording[static_cast<std::size_t>(k)].number = k;
    recording[static_cast<std::size_t>(k)].time_s = 0.1 * k;
  }
  const BenchFigures f = RunBench(recording, {});
  EXPECT_EQ(f.frames, 10);
  EXPECT_EQ(f.gospa_mean(), 0.0);
}

TEST(GenerateTraffic, HasWhatItsSpecSays) {
  const TrafficSpec spec{.vehicles = 200, .seed = 6};
  const Recording recording = GenerateTraffic(spec);
  ASSERT_EQ(recording.size(), 220u);
  std::size_t detections = 0;
  double nearest = 1e9;
  for (const Frame& frame : recording) {
    ASSERT_EQ(frame.truth.size(), 200u);
    detections += frame.detections.size();
    for (std::size_t i = 0; i < frame.truth.size(); ++i) {
      const VehiclePose& a = frame.truth[i];
      EXPECT_GE(a.speed_mps, 17.0);
      EXPECT_LE(a.speed_mps, 27.0);
      for (std::size_t j = 0; j < i; ++j) {
        if (i % 8 != j % 8) continue;  // Other lanes.
        const VehiclePose& b = frame.truth[j];
        nearest = std::min(nearest, std::hypot(a.x_m - b.x_m, a.y_m - b.y_m));
      }
    }
  }
  // 0.95 detected and 0.05 clutter, with its own spread over 44 000.
  EXPECT_NEAR(static_cast<double>(detections), 220.0 * 200.0, 300.0);
  EXPECT_GT(nearest, 5.0);  // Nobody drives through anybody.
}

TEST(GenerateTraffic, VehiclesMoveAsTheirPosesSay) {
  for (const double curvature : {0.0, 0.01, -0.005}) {
    const Recording r = Traffic(16, 7, curvature);
    for (std::size_t k = 1; k < r.size(); ++k) {
      for (std::size_t i = 0; i < 16; ++i) {
        const VehiclePose& a = r[k - 1].truth[i];
        const VehiclePose& b = r[k].truth[i];
        const double v = 0.5 * (a.speed_mps + b.speed_mps);
        const double yaw = a.yaw_rad + 0.5 * WrapAngle(b.yaw_rad - a.yaw_rad);
        EXPECT_NEAR(b.x_m - a.x_m, 0.1 * v * std::cos(yaw), 2e-3);
        EXPECT_NEAR(b.y_m - a.y_m, 0.1 * v * std::sin(yaw), 2e-3);
        EXPECT_NEAR(WrapAngle(b.yaw_rad - a.yaw_rad), 0.1 * b.yaw_rate_radps, 2e-3);
      }
    }
  }
}

TEST(Rotated, QuarterTurnsAreExact) {
  const Recording recording = Traffic(8, 8);
  const Recording turned = Rotated(recording, 0.5 * kPi);
  for (std::size_t k = 0; k < recording.size(); ++k) {
    for (std::size_t i = 0; i < recording[k].detections.size(); ++i) {
      EXPECT_EQ(turned[k].detections[i].x_m, -recording[k].detections[i].y_m);
      EXPECT_EQ(turned[k].detections[i].y_m, recording[k].detections[i].x_m);
    }
  }
}

}  // namespace
}  // namespace v2vouch::bench
