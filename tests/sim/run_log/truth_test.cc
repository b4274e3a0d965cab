// SPDX-License-Identifier: Apache-2.0
#include "sim/run_log/truth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"
#include "sim/run_log/scene_specs.h"

namespace v2vouch::evaluation {
namespace {

/// A car on a circle of 15 m radius at 9 m/s, which is a hard bend.
PlanarMotion OnCircle(double t_s) {
  constexpr double kRadius = 15.0, kSpeed = 9.0;
  const double yaw = kSpeed / kRadius * t_s;
  return {kRadius * std::sin(yaw), kRadius * (1.0 - std::cos(yaw)),
          WrapAngle(yaw),          kSpeed,
          kSpeed / kRadius,        0.0};
}

TruthSample Sampled(double t_s) {
  TruthSample sample;
  sample.stamp = FromMicros(std::llround(t_s * 1e6));
  sample.motion = OnCircle(t_s);
  return sample;
}

TEST(MotionSamples, InterpolatesATurnToBelowAMillimetre) {
  MotionSamples samples;
  for (int k = 0; k <= 400; ++k) samples.Add(Sampled(0.05 * k));
  for (double t_s = 0.0; t_s < 20.0; t_s += 0.0137) {
    const auto motion = samples.At(FromMicros(std::llround(t_s * 1e6)));
    ASSERT_TRUE(motion.has_value());
    EXPECT_LT((motion->position() - OnCircle(t_s).position()).norm(), 1e-3) << t_s;
    EXPECT_LT(std::abs(AngleDifference(motion->yaw_rad, OnCircle(t_s).yaw_rad)), 1e-4) << t_s;
  }
}

TEST(MotionSamples, SaysNothingOutsideOrAcrossAGap) {
  MotionSamples samples;
  samples.Add(Sampled(1.0));
  samples.Add(Sampled(1.05));
  samples.Add(Sampled(2.0));
  EXPECT_FALSE(samples.At(FromMicros(999'999)));
  EXPECT_TRUE(samples.At(FromMicros(1'000'000)));
  EXPECT_TRUE(samples.At(FromMicros(1'049'999)));
  EXPECT_FALSE(samples.At(FromMicros(1'500'000)));
  EXPECT_TRUE(samples.At(FromMicros(2'000'000)));
  EXPECT_FALSE(samples.At(FromMicros(2'000'001)));
  EXPECT_EQ(samples.InForce(FromMicros(1'500'000)), nullptr);
}

TEST(Predict, FollowsACircleExactly) {
  for (const double dt_s : {-0.2, 0.03, 0.1, 0.5}) {
    const PlanarMotion out = Predict(OnCircle(1.0), dt_s);
    EXPECT_LT((out.position() - OnCircle(1.0 + dt_s).position()).norm(), 1e-9);
  }
}

TEST(Predict, BrakingEndsAtRest) {
  const PlanarMotion out = Predict({0.0, 0.0, 0.0, 2.0, 0.0, -4.0}, 3.0);
  EXPECT_DOUBLE_EQ(out.speed_mps, 0.0);
  EXPECT_DOUBLE_EQ(out.x_m, 0.5);
}

TEST(SceneSpecs, ReadWhatIsThereAndKeepDefaultsForTheRest) {
  const SceneSpecs specs = ReadSceneSpecs(R"(
name: test
unknown: {a: 1}
sensors: {mode: ideal_points, noise_scale: 2.0}
vehicle:
  length_m: 5.0
  radars: [{name: NOSE, range_sigma_m: 0.4, yaw_deg: 90}]
bsm: {gnss: {bias_sigma_m: 2.5}}
buildings: [{outline: [0, 0, 4, 0, 4, 3]}]
)");
  EXPECT_TRUE(specs.is_given);
  EXPECT_TRUE(specs.has_ideal_points);
  EXPECT_EQ(specs.ego_length_m, 5.0);
  ASSERT_EQ(specs.sensors.size(), 2u);  // One radar, the default camera.
  EXPECT_EQ(specs.sensors[0].channel, "RADAR_NOSE");
  EXPECT_DOUBLE_EQ(specs.sensors[0].range_sigma_m, 0.8);
  EXPECT_DOUBLE_EQ(specs.sensors[0].yaw_rad, kPi / 2.0);
  EXPECT_EQ(specs.sender.bias_sigma_m, 2.5);
  EXPECT_EQ(specs.buildings.at(0).size(), 3u);
}

TEST(SceneSpecs, TextThatIsNoYamlLeavesTheShippedVehicle) {
  const SceneSpecs specs = ReadSceneSpecs("{ [ not yaml");
  EXPECT_FALSE(specs.is_given);
  EXPECT_EQ(specs.sensors.size(), 4u);
}

}  // namespace
}  // namespace v2vouch::evaluation
