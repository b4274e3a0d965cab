// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"
#include "sim/metrics/information_filter.h"
#include "sim/metrics/scoring.h"

namespace v2vouch::evaluation {
namespace {

SensorSpec Radar() {
  SensorSpec radar;
  radar.range_sigma_m = 0.25;
  radar.azimuth_sigma_rad = FromDegrees(0.5);
  radar.range_rate_sigma_mps = 0.1;
  return radar;
}

SensorSpec Camera() {
  SensorSpec camera;
  camera.kind = SensorKind::kCamera;
  camera.z_m = 1.4;
  camera.azimuth_sigma_rad = FromDegrees(0.15);
  camera.depression_sigma_rad = FromDegrees(0.2);
  return camera;
}

/// RMS bound of a vehicle that keeps its distance ahead, after ten seconds of looks.
InformationFilter Settled(double range_m, bool with_camera, double along, double across) {
  InformationFilter filter({along, across, 1.5}, {});
  const PlanarMotion ego{0.0, 0.0, 0.0, 10.0, 0.0, 0.0};
  const PlanarMotion target{range_m, 0.0, 0.0, 10.0, 0.0, 0.0};
  for (int k = 0; k < 200; ++k) {
    filter.Predict(0.05, target.yaw_rad);
    filter.AddSensor(Radar(), ego, target, 0.95);
    if (with_camera && k % 2 == 0) filter.AddSensor(Camera(), ego, target, 0.9);
    filter.Apply();
  }
  return filter;
}

double Rms(const InformationFilter& filter) { return std::sqrt(filter.position_variance_m2()); }

// An independent program's figures for the same sensors (20 Hz radar 0.25 m, 0.5 deg, 0.1 m/s,
// P_D 0.95; 10 Hz camera 0.15 deg, pitch 0.2 deg at 1.4 m, P_D 0.9), published to 0.01 m.
TEST(InformationFilter, SteadyBoundAgreesWithAnIndependentCalculation) {
  constexpr double kRadar[][2] = {{20.0, 0.09}, {40.0, 0.15}, {60.0, 0.20}, {80.0, 0.26}};
  for (const auto& [range_m, expected_m] : kRadar) {
    EXPECT_NEAR(Rms(Settled(range_m, false, 1.5, 0.6)), expected_m, 0.012) << range_m;
  }
  constexpr double kBoth[][2] = {{20.0, 0.05}, {40.0, 0.08}, {60.0, 0.11}, {80.0, 0.13}};
  for (const auto& [range_m, expected_m] : kBoth) {
    EXPECT_NEAR(Rms(Settled(range_m, true, 1.5, 0.6)), expected_m, 0.012) << range_m;
  }
}

// The same source: RMS after losing a vehicle at 60 m, normal driving.
TEST(InformationFilter, CoastingGrowsAsAnIndependentCalculationSays) {
  InformationFilter filter = Settled(60.0, false, 1.5, 0.6);
  constexpr double kAfter[][2] = {{1.0, 0.9}, {2.0, 2.4}, {3.0, 5.0}, {4.0, 8.5}};
  double t_s = 0.0;
  for (const auto& [after_s, expected_m] : kAfter) {
    for (; t_s < after_s - 1e-9; t_s += 0.05) filter.Predict(0.05, 0.0);
    EXPECT_NEAR(Rms(filter), expected_m, 0.1 * expected_m + 0.05) << after_s;
  }
}

TEST(InformationFilter, BsmAloneCannotBeatItsBias) {
  SenderSpec sender;
  sender.bias_sigma_m = 1.0;
  sender.markov_sigma_m = 0.0;
  InformationFilter filter({1.0, 0.5, 1.5}, sender);
  const PlanarMotion target{30.0, 5.0, 0.3, 10.0, 0.0, 0.0};
  for (int k = 0; k < 600; ++k) {
    filter.Predict(0.05, target.yaw_rad);
    if (k % 2 == 0) filter.AddBsm(target);
    filter.Apply();
  }
  EXPECT_GT(Rms(filter), 1.0 * std::sqrt(2.0) - 1e-6);
  EXPECT_LT(Rms(filter), 1.05 * std::sqrt(2.0));
}

TEST(InformationFilter, SightFirstTeachesTheBiasAndHidingKeepsIt) {
  SenderSpec sender;
  sender.bias_sigma_m = 1.06;
  sender.white_sigma_m = 0.7;
  const auto run = [&](bool with_bsm) {
    InformationFilter filter({1.5, 0.6, 1.5}, sender);
    const PlanarMotion ego;
    const PlanarMotion target{40.0, 0.0, 0.0, 10.0, 0.0, 0.0};
    for (int k = 0; k < 200; ++k) {  // 6 s seen, 4 s hidden.
      filter.Predict(0.05, 0.0);
      if (k < 120) filter.AddSensor(Radar(), ego, target, 0.95);
      if (with_bsm && k % 2 == 0) filter.AddBsm(target);
      filter.Apply();
    }
    return Rms(filter);
  };
  EXPECT_LT(run(true), 0.6);
  EXPECT_GT(run(false), 6.0);
}

TEST(InformationFilter, MoreInformationNeverHurts) {
  Random random(5);
  InformationFilter few({1.0, 0.5, 1.5}, {});
  InformationFilter many = few;
  const PlanarMotion ego{0.0, 0.0, 0.1, 8.0, 0.05, 0.0};
  for (int k = 0; k < 200; ++k) {
    const PlanarMotion target{
        random.Uniform(5.0, 90.0), random.Uniform(-40.0, 40.0), 1.0, 9.0, 0.0, 0.0};
    few.Predict(0.05, 1.0);
    many.Predict(0.05, 1.0);
    if (k % 3 == 0) few.AddSensor(Radar(), ego, target, 0.5);
    if (k % 3 == 0) many.AddSensor(Radar(), ego, target, 0.5);
    many.AddBsm(target);
    few.Apply();
    many.Apply();
    ASSERT_LE(many.position_variance_m2(), few.position_variance_m2() * (1.0 + 1e-9));
    ASSERT_GT(many.position_variance_m2(), 0.0);
  }
}

// A vehicle 30 m ahead that a radar looks at from the start, a camera from the third second.
RunLog LookedAt(double speed_mps) {
  RunLog log;
  log.specs.sensors = {Radar(), Camera()};
  log.specs.sensors[0].channel = "RADAR_FRONT";
  log.specs.sensors[1].channel = "CAMERA_FRONT";
  TruthObject& object = log.truth.objects.emplace_back();
  object.id = 1;
  object.object_class = 1;
  for (int k = 0; k <= 100; ++k) {
    const Timestamp t = FromMicros(1'000'000 + 50'000 * k);
    TruthSample ego{.stamp = t, .motion = {}, .is_hidden = false, .sender = 0, .looks = {}};
    log.truth.ego.Add(ego);
    TruthSample sample = ego;
    sample.motion = {30.0 + speed_mps * 0.05 * k, 0.0, 0.0, speed_mps, 0.0, 0.0};
    sample.looks = {{"RADAR_FRONT", 0.95, 1.0}, {"CAMERA_FRONT", 0.9, 1.0}};
    object.motion.Add(sample);
    log.looks.push_back({t, t, 0});
    if (k >= 60) log.looks.push_back({t, t, 1});
  }
  return log;
}

TEST(Bound, AStandingRadarReturnAloneStartsNoLocalTrack) {
  const auto first_held = [](const RunLog& log, bool plain) {
    const std::vector<Timestamp> grid = MakeGrid(log.truth, {});
    const Bound bound(log, grid);
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const BoundCell& cell = bound.At(ListKind::kLocal, 0, k);
      if (plain ? cell.is_held_plain : cell.is_held) return ToSeconds(grid[k] - grid[0]);
    }
    return -1.0;
  };
  EXPECT_NEAR(first_held(LookedAt(5.0), false), 0.05, 1e-9);
  EXPECT_NEAR(first_held(LookedAt(0.0), true), 0.05, 1e-9);
  EXPECT_NEAR(first_held(LookedAt(0.0), false), 3.05, 1e-9);
}

// E min(d^2, c^2) of an isotropic normal error, against a large sample.
TEST(TruncatedSquare, AgreesWithSampling) {
  Random random(9);
  for (const double variance : {0.5, 20.0, 72.0, 400.0}) {
    double sum = 0.0;
    constexpr int kSamples = 200000;
    for (int k = 0; k < kSamples; ++k) {
      const double x = random.Normal(0.0, std::sqrt(variance / 2.0));
      const double y = random.Normal(0.0, std::sqrt(variance / 2.0));
      sum += std::min(x * x + y * y, 100.0);
    }
    EXPECT_NEAR(TruncatedSquare(variance, 10.0), sum / kSamples, 0.01 * variance + 0.3);
  }
}

}  // namespace
}  // namespace v2vouch::evaluation
