// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/ego.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/sensors/scene.h"

namespace v2vouch::sim {
namespace {

TEST(HeadingOf, TurnsEastCountingIntoNorthClockwise) {
  EXPECT_NEAR(HeadingOf(kPi / 2), 0.0, 1e-12);
  EXPECT_NEAR(HeadingOf(0.0), kPi / 2, 1e-12);
  EXPECT_NEAR(HeadingOf(kPi), 1.5 * kPi, 1e-12);
}

TEST(GeodeticOf, NorthConvergesTowardsThePole) {
  OriginSpec origin;
  const auto plane = PlaneOf(origin);
  const GeodeticPlace place = GeodeticOf(plane, {1000.0, 0.0});
  // Meridian convergence: longitude difference times sine of latitude. East of the origin true
  // north leans to the left of W's north, so the plane's x axis points to the right of true east.
  const double expected = FromDegrees(place.longitude_deg - ToDegrees(origin.longitude_rad)) *
                          std::sin(origin.latitude_rad);
  EXPECT_NEAR(std::abs(place.turn_rad), expected, 0.02 * expected);
}

TEST(EgoGnss, WithoutErrorsItIsTheAntenna) {
  Scenario scenario = StandingEgo();
  scenario.gnss.error = {
      .bias_sigma_m = 0, .markov_sigma_m = 0, .white_sigma_m = 0, .height_sigma_m = 0};
  scenario.gnss.heading_bias_rad = 0.0;
  scenario.gnss.heading_sigma_rad = 0.0;
  scenario.gnss.velocity_sigma_mps = 0.0;
  const auto world = MakeWorld(scenario);
  Snapshot snapshot = world->At(0.0);
  snapshot.ego.yaw_rad = 2.0;
  snapshot.ego.speed_mps = 9.0;
  EgoGnssSimulator gnss(*world, 1);
  gnss_fix_t fix{};
  gnss.Measure(snapshot, 0, 0.1, fix);
  double x = 0.0, y = 0.0, z = 0.0;
  PlaneOf(scenario.origin)
      .Forward(ToDegrees(fix.latitude_rad), ToDegrees(fix.longitude_rad), fix.altitude_m, x, y, z);
  const Vec2 antenna = snapshot.ego.PointAt(scenario.vehicle.antenna_x_m, 0.0);
  EXPECT_NEAR(x, antenna.x(), 1e-6);
  EXPECT_NEAR(y, antenna.y(), 1e-6);
  EXPECT_NEAR(fix.heading_rad, HeadingOf(2.0), 1e-5);
  EXPECT_NEAR(fix.velocity_east_mps, 9.0 * std::cos(2.0), 1e-4);
  EXPECT_NEAR(fix.velocity_north_mps, 9.0 * std::sin(2.0), 1e-4);
}

TEST(Odometry, ErrorsAreThoseOfTheScenario) {
  Scenario scenario = StandingEgo();
  const auto world = MakeWorld(scenario);
  Snapshot snapshot = world->At(0.0);
  snapshot.ego.speed_mps = 20.0;
  snapshot.ego.yaw_rate_radps = 0.1;
  const OdometrySimulator odometry(*world, 5);
  ego_motion_t motion{};
  double speed = 0.0, yaw_rate = 0.0, squares = 0.0;
  constexpr int kCount = 3000;
  for (int seq = 0; seq < kCount; ++seq) {
    odometry.Measure(snapshot, seq, motion);
    speed += motion.speed_mps / kCount;
    yaw_rate += motion.yaw_rate_radps / kCount;
    const double error = motion.speed_mps - scenario.odometry.speed_scale * 20.0;
    squares += error * error / kCount;
  }
  EXPECT_NEAR(speed, scenario.odometry.speed_scale * 20.0, 0.003);
  EXPECT_NEAR(yaw_rate, 0.1 + scenario.odometry.yaw_rate_bias_radps, 1e-4);
  EXPECT_NEAR(std::sqrt(squares), scenario.odometry.speed_sigma_mps, 0.003);
}

TEST(GaussMarkov, HasItsSigmaAndItsTimeConstant) {
  Random random(3);
  GaussMarkov process(2.0, 10.0, random);
  std::vector<double> values;
  for (int i = 0; i < 60000; ++i) values.push_back(process.Step(1.0, random));
  double variance = 0.0, lagged = 0.0;
  for (std::size_t i = 0; i + 10 < values.size(); ++i) {
    variance += values[i] * values[i] / 60000.0;
    lagged += values[i] * values[i + 10] / 60000.0;
  }
  EXPECT_NEAR(std::sqrt(variance), 2.0, 0.12);
  EXPECT_NEAR(lagged / variance, std::exp(-1.0), 0.06);
}

}  // namespace
}  // namespace v2vouch::sim
