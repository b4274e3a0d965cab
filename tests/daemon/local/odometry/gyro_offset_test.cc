// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/odometry/gyro_offset.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

constexpr double kStep_s = 0.02;

// Reads `offset` plus noise and `turn` for `seconds`; the yaw that was integrated.
double Drive(GyroOffset& gyro, double& time_s, double seconds, double offset_degps,
             double turn_degps, Standstill standstill) {
  double yaw_rad = 0.0;
  for (double end = time_s + seconds; time_s < end; time_s += kStep_s) {
    const double noise = 0.1 * std::sin(50.0 * time_s);
    yaw_rad += kStep_s * gyro.Read(FromMicros(1'700'000'000'000'000) + FromSeconds(time_s),
                                   FromDegrees(offset_degps + turn_degps + noise), standstill);
  }
  return yaw_rad;
}

TEST(GyroOffset, AStandingCarDoesNotTurnHoweverLong) {
  for (const double offset : {-2.0, -0.5, 0.1, 0.17, 0.5, 2.5}) {
    GyroOffset gyro;
    double time_s = 0.0;
    EXPECT_EQ(Drive(gyro, time_s, 360.0, offset, 0.0, Standstill::kWheels), 0.0) << offset;
    EXPECT_NEAR(ToDegrees(gyro.offset_radps()), offset, 0.02);
    EXPECT_TRUE(gyro.is_learnt());
    EXPECT_LT(ToDegrees(gyro.sigma_radps()), 0.05);
  }
}

TEST(GyroOffset, WhatWasLearntIsTakenOffWhileDriving) {
  GyroOffset gyro;
  double time_s = 0.0;
  EXPECT_NEAR(ToDegrees(Drive(gyro, time_s, 10.0, 0.5, 0.0, Standstill::kNo)), 5.0, 0.1);
  Drive(gyro, time_s, 2.0, 0.5, 0.0, Standstill::kWheels);
  EXPECT_NEAR(ToDegrees(Drive(gyro, time_s, 60.0, 0.5, 0.0, Standstill::kNo)), 0.0, 2.0);
  EXPECT_NEAR(ToDegrees(Drive(gyro, time_s, 10.0, 0.5, 9.0, Standstill::kNo)), 90.0, 0.5);
}

TEST(GyroOffset, ADriftingOffsetIsFollowed) {
  GyroOffset gyro;
  double time_s = 0.0;
  double yaw_rad = 0.0;
  for (int i = 0; i < 300; ++i) {  // 0.2 deg/s up in five minutes.
    yaw_rad += Drive(gyro, time_s, 1.0, 0.3 + 0.2 * i / 300.0, 0.0, Standstill::kWheels);
  }
  EXPECT_EQ(yaw_rad, 0.0);
  EXPECT_NEAR(ToDegrees(gyro.offset_radps()), 0.5, 0.05);
}

TEST(GyroOffset, ATurnBelowTheWheelsDeadbandIsNoOffset) {
  GyroOffset gyro;
  double time_s = 0.0;
  // Unknown offset: 6 deg/s is none.
  EXPECT_NEAR(ToDegrees(Drive(gyro, time_s, 5.0, 0.0, 6.0, Standstill::kWheels)), 30.0, 0.5);
  Drive(gyro, time_s, 3.0, 0.2, 0.0, Standstill::kWheels);
  EXPECT_NEAR(ToDegrees(gyro.offset_radps()), 0.2, 0.03);
  // Known offset: 2 deg/s more is a turn.
  EXPECT_NEAR(ToDegrees(Drive(gyro, time_s, 5.0, 0.2, 2.0, Standstill::kWheels)), 10.0, 1.0);
  EXPECT_NEAR(ToDegrees(gyro.offset_radps()), 0.2, 0.1);
}

TEST(GyroOffset, AnOffsetThatSteppedIsLearntAnewWhereRadarSeesTheCarStand) {
  GyroOffset gyro;
  double time_s = 0.0;
  Drive(gyro, time_s, 3.0, 0.2, 0.0, Standstill::kSeen);
  EXPECT_EQ(Drive(gyro, time_s, 30.0, 1.2, 0.0, Standstill::kSeen), 0.0);
  GyroOffset by_wheels;
  time_s = 0.0;
  Drive(by_wheels, time_s, 3.0, 0.2, 0.0, Standstill::kWheels);
  EXPECT_NEAR(ToDegrees(Drive(by_wheels, time_s, 60.0, 1.2, 0.0, Standstill::kWheels)), 10.0, 1.5);
}

}  // namespace
}  // namespace v2vouch
