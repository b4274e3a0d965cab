// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/ego_track.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

std::vector<EgoMotion> Circle(double speed, double yaw_rate, double sigma, int samples) {
  Random random(4);
  std::vector<EgoMotion> motion;
  for (int i = 0; i < samples; ++i) {
    EgoMotion m;
    m.stamp = FromMicros(1'000'000 + 20'000 * i);
    m.speed_mps = speed + random.Normal(0.0, sigma);
    m.speed_sigma_mps = 0.15;
    m.yaw_rate_radps = yaw_rate;
    m.yaw_rate_sigma_radps = 0.002;
    motion.push_back(m);
  }
  return motion;
}

TEST(EgoTrack, DeadReckonsACircleBackToItsStart) {
  const double yaw_rate = 2.0 * kPi / 20.0;
  const EgoTrack ego(Circle(10.0, yaw_rate, 0.0, 1001));
  const auto end = ego.At(FromMicros(21'000'000));
  ASSERT_TRUE(end);
  EXPECT_NEAR(end->x_m, 0.0, 0.01);
  EXPECT_NEAR(end->y_m, 0.0, 0.01);
  EXPECT_NEAR(end->yaw_rad, 2.0 * kPi, 1e-9);
  const auto between = ego.At(FromMicros(1'011'000));
  EXPECT_NEAR(between->x_m, 0.11, 1e-4);
}

TEST(EgoTrack, KnowsNothingFarFromASample) {
  const EgoTrack ego(Circle(10.0, 0.0, 0.0, 50));
  EXPECT_FALSE(ego.Nearest(FromMicros(900'000)));
  EXPECT_FALSE(ego.At(FromMicros(2'100'000)));
  EXPECT_EQ(ego.Nearest(FromMicros(1'049'000)), 2u);
  EXPECT_FALSE(EgoTrack({}).Nearest(FromMicros(0)));
}

TEST(EgoTrack, FindsTheWhiteNoiseThatAStatedSigmaHides) {
  EXPECT_NEAR(EgoTrack(Circle(10.0, 0.0, 0.05, 4000)).speed_sigma_mps(), 0.05, 0.004);
  // Less than a quarter of what is stated is not believed: it may have been smoothed.
  EXPECT_DOUBLE_EQ(EgoTrack(Circle(10.0, 0.0, 0.001, 4000)).speed_sigma_mps(), 0.25 * 0.15);
}

}  // namespace
}  // namespace v2vouch
