// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/odometry/odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

namespace v2vouch {
namespace {

constexpr Timestamp kStart = FromMicros(1'700'000'000'000'000);

Timestamp At(double seconds) { return kStart + FromSeconds(seconds); }

EgoMotion Sample(double seconds, double speed_mps, double yaw_rate_radps = 0.0) {
  EgoMotion sample;
  sample.stamp = At(seconds);
  sample.speed_mps = speed_mps;
  sample.yaw_rate_radps = yaw_rate_radps;
  return sample;
}

TEST(EgoOdometry, StartsAtTheOriginOfO) {
  EgoOdometry odometry;
  EXPECT_FALSE(odometry.newest());
  EXPECT_FALSE(odometry.StateAt(At(0.0)));
  odometry.OnEgoMotion(Sample(0.0, 10.0, 0.1));
  EXPECT_EQ(odometry.newest(), At(0.0));
  EXPECT_EQ(odometry.StateAt(At(0.0))->X_OB, (Pose<Odometry, Body>{}));
  EXPECT_FALSE(odometry.StateAt(At(-0.000001)));
}

TEST(EgoOdometry, DrivesACircleExactly) {
  EgoOdometry odometry;
  const double v = 8.0;
  const double w = 0.5;
  for (int i = 0; i <= 600; ++i) odometry.OnEgoMotion(Sample(0.02 * i, v, w));
  // Once round takes 4 pi s = 12.57 s: ask inside the history and past the newest sample.
  for (const double t : {11.0, 11.991, 12.0, 12.3}) {
    const auto state = odometry.StateAt(At(t));
    ASSERT_TRUE(state);
    EXPECT_NEAR(state->X_OB.x_m(), v / w * std::sin(w * t), 1e-9);
    EXPECT_NEAR(state->X_OB.y_m(), v / w * (1.0 - std::cos(w * t)), 1e-9);
    EXPECT_NEAR(AngleDifference(state->X_OB.yaw_rad(), w * t), 0.0, 1e-9);
    EXPECT_DOUBLE_EQ(state->speed_mps, v);
    EXPECT_EQ(state->stamp, At(t));
  }
}

TEST(EgoOdometry, BrakesInAStraightLineExactly) {
  EgoOdometry odometry;
  const double v = 20.0;
  const double a = -3.0;
  for (int i = 0; i <= 50; ++i) odometry.OnEgoMotion(Sample(0.1 * i, v + a * 0.1 * i));
  const auto state = odometry.StateAt(At(5.0));
  ASSERT_TRUE(state);
  EXPECT_NEAR(state->X_OB.x_m(), v * 5.0 + 0.5 * a * 25.0, 1e-9);
  EXPECT_DOUBLE_EQ(state->X_OB.y_m(), 0.0);
  // No acceleration was sent: it is read from the speeds.
  EXPECT_NEAR(state->accel_mps2, a, 1e-9);
  EXPECT_NEAR(odometry.StateAt(At(5.3))->speed_mps, v + a * 5.3, 1e-9);
}

// Property: the closed form of turning while accelerating agrees with fine numerical integration,
// on both sides of the switch to the series.
TEST(EgoOdometryProperty, ArcMatchesNumericalIntegration) {
  for (const double w : {0.0, 1e-7, -0.0199, 0.0201, -0.3, 1.2}) {
    for (const double a : {-4.0, 0.0, 2.5}) {
      EgoOdometry odometry;
      EgoMotion sample = Sample(0.0, 12.0, w);
      sample.accel_long_mps2 = a;
      odometry.OnEgoMotion(sample);
      const double t = 0.5;
      double x = 0.0;
      double y = 0.0;
      const int steps = 20000;
      for (int i = 0; i < steps; ++i) {
        const double s = t * (i + 0.5) / steps;
        x += (12.0 + a * s) * std::cos(w * s) * t / steps;
        y += (12.0 + a * s) * std::sin(w * s) * t / steps;
      }
      const auto state = odometry.StateAt(At(t));
      ASSERT_TRUE(state);
      EXPECT_NEAR(state->X_OB.x_m(), x, 1e-8) << "w = " << w << ", a = " << a;
      EXPECT_NEAR(state->X_OB.y_m(), y, 1e-8) << "w = " << w << ", a = " << a;
    }
  }
}

TEST(EgoOdometry, StateAtUsesTheNewestSampleNotLaterThanTheTimeAsked) {
  EgoOdometry before;
  before.OnEgoMotion(Sample(0.0, 10.0));
  before.OnEgoMotion(Sample(0.1, 10.0));
  EgoOdometry after = before;
  after.OnEgoMotion(Sample(0.2, 30.0, 1.0));
  for (const double t : {0.0, 0.05, 0.1, 0.199999}) {
    EXPECT_EQ(before.StateAt(At(t))->X_OB, after.StateAt(At(t))->X_OB);
    EXPECT_EQ(before.StateAt(At(t))->speed_mps, after.StateAt(At(t))->speed_mps);
  }
  EXPECT_DOUBLE_EQ(after.StateAt(At(0.2))->speed_mps, 30.0);
}

TEST(EgoOdometry, SaysNothingBeyondTheLongestGap) {
  EgoOdometry odometry;
  odometry.OnEgoMotion(Sample(0.0, 10.0));
  EXPECT_TRUE(odometry.StateAt(At(0.5)));
  EXPECT_FALSE(odometry.StateAt(At(0.500001)));
  // A sample after the gap: the time inside it stays unknown, O goes on without a break.
  odometry.OnEgoMotion(Sample(2.0, 20.0));
  EXPECT_FALSE(odometry.StateAt(At(1.0)));
  EXPECT_NEAR(odometry.StateAt(At(2.0))->X_OB.x_m(), 30.0, 1e-9);
}

TEST(EgoOdometry, ForgetsWhatIsOlderThanItsHistory) {
  EgoOdometry odometry;
  const int count = static_cast<int>(EgoOdometry::kHistory) + 72;
  for (int i = 0; i < count; ++i) odometry.OnEgoMotion(Sample(0.01 * i, 10.0));
  EXPECT_FALSE(odometry.StateAt(At(0.719)));
  ASSERT_TRUE(odometry.StateAt(At(0.72)));
  EXPECT_NEAR(odometry.StateAt(At(0.72))->X_OB.x_m(), 7.2, 1e-9);
}

TEST(EgoOdometry, IgnoresSamplesOutOfOrderAndReplacesAnEqualStamp) {
  EgoOdometry odometry;
  odometry.OnEgoMotion(Sample(0.0, 10.0));
  odometry.OnEgoMotion(Sample(0.1, 10.0));
  odometry.OnEgoMotion(Sample(0.05, 99.0));
  EXPECT_EQ(odometry.newest(), At(0.1));
  EXPECT_NEAR(odometry.StateAt(At(0.1))->X_OB.x_m(), 1.0, 1e-12);
  odometry.OnEgoMotion(Sample(0.1, 12.0));
  EXPECT_NEAR(odometry.StateAt(At(0.1))->X_OB.x_m(), 1.0, 1e-12);
  EXPECT_DOUBLE_EQ(odometry.StateAt(At(0.1))->speed_mps, 12.0);
}

TEST(EgoOdometry, BrakingNeverTurnsIntoReversing) {
  EgoOdometry odometry;
  EgoMotion sample = Sample(0.0, 1.0);
  sample.accel_long_mps2 = -5.0;
  odometry.OnEgoMotion(sample);
  const auto state = odometry.StateAt(At(0.5));
  ASSERT_TRUE(state);
  EXPECT_DOUBLE_EQ(state->speed_mps, 0.0);
  EXPECT_NEAR(state->X_OB.x_m(), 0.1, 1e-12);  // v^2 / 2a
  // Reverse gear alike.
  sample.stamp = At(1.0);
  sample.speed_mps = -1.0;
  sample.accel_long_mps2 = -2.0;
  odometry.OnEgoMotion(sample);
  EXPECT_DOUBLE_EQ(odometry.StateAt(At(1.5))->speed_mps, -2.0);
}

TEST(EgoOdometry, IsSmallEnoughToBeACheckpoint) {
  EXPECT_LE(sizeof(EgoOdometry), 12'000U);
  EXPECT_TRUE(std::is_trivially_copyable_v<EgoOdometry>);
}

}  // namespace
}  // namespace v2vouch
