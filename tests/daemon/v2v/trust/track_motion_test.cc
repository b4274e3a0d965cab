// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/track_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

Timestamp At(double time_s) { return FromMicros(1'000'000'000) + FromSeconds(time_s); }

// Velocities at 10 Hz; @return when it broke off first, or NaN.
double FirstBreak(const std::function<Eigen::Vector2d(double)>& velocity, double for_s = 10.0) {
  TrackMotion motion;
  for (int i = 0; i < static_cast<int>(10.0 * for_s); ++i) {
    if (motion.Observe(At(0.1 * i), velocity(0.1 * i))) return 0.1 * i;
  }
  return std::nan("");
}

TEST(TrackMotion, BrakingAndTurningAsTyresAllowIsNoBreak) {
  const auto braking = [](double t) {
    return Eigen::Vector2d(std::max(0.0, 30.0 - 8.0 * std::max(0.0, t - 2.0)), 0.0);
  };
  EXPECT_TRUE(std::isnan(FirstBreak(braking)));
  const auto turning = [](double t) {  // 10 m/s on a radius of 14 m: 7 m/s^2.
    return Eigen::Vector2d(10.0 * std::cos(0.7 * t), 10.0 * std::sin(0.7 * t));
  };
  EXPECT_TRUE(std::isnan(FirstBreak(turning)));
}

TEST(TrackMotion, HonestNoiseIsNoBreak) {
  Random random(5);
  double x_mps = 0.0;
  double y_mps = 0.0;
  const auto noisy = [&](double) {  // 0.3 m/s per axis, correlated over half a second.
    const double drive = 0.3 * std::sqrt(1.0 - std::exp(-0.4));
    x_mps = std::exp(-0.2) * x_mps + drive * random.Normal();
    y_mps = std::exp(-0.2) * y_mps + drive * random.Normal();
    return Eigen::Vector2d(25.0 + x_mps, y_mps);
  };
  EXPECT_TRUE(std::isnan(FirstBreak(noisy, 3600.0)));
}

// 5 m/s within 0.4 s: a reflection that runs along the side of a car.
TEST(TrackMotion, AReflectionThatRunsAlongIsABreak) {
  const auto running = [](double t) {
    return Eigen::Vector2d(33.0 + 5.0 * std::clamp((t - 2.0) / 0.4, 0.0, 1.0), 0.0);
  };
  EXPECT_NEAR(FirstBreak(running), 2.4, 0.11);
}

TEST(TrackMotion, GoingOverToAParkedCarIsABreakAndIsRememberedForAWhile) {
  TrackMotion motion;
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(motion.Observe(At(0.1 * i), {5.5, 0.0}));
  EXPECT_FALSE(motion.HasBroken(At(1.9)));
  EXPECT_TRUE(motion.Observe(At(2.0), {0.0, 0.0}));
  EXPECT_FALSE(motion.Observe(At(2.1), {0.0, 0.0})) << "once";
  EXPECT_TRUE(motion.HasBroken(At(4.9)));
  EXPECT_FALSE(motion.HasBroken(At(5.1)));
}

TEST(TrackMotion, NothingIsSaidAcrossAGapOrOutOfOrder) {
  TrackMotion motion;
  EXPECT_FALSE(motion.Observe(At(0.0), {5.5, 0.0}));
  EXPECT_FALSE(motion.Observe(At(-0.1), {30.0, 0.0}));
  EXPECT_FALSE(motion.Observe(At(1.0), {30.0, 0.0}));
}

}  // namespace
}  // namespace v2vouch
