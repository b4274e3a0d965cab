// SPDX-License-Identifier: Apache-2.0
#include "sim/scorecard/silhouette.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::evaluation {
namespace {

const Eigen::Vector2d kHere = Eigen::Vector2d::Zero();

TEST(Silhouette, OfABoxAheadSpansItsNearCorners) {
  const Silhouette s = SilhouetteOf({{20.0, 0.0}, 0.0, 4.0, 2.0}, kHere);
  EXPECT_NEAR(s.middle_rad, 0.0, 1e-9);
  EXPECT_NEAR(s.half_width_rad, std::atan2(1.0, 18.0), 1e-9);
  EXPECT_NEAR(s.range_m, 20.0, 1e-9);
}

TEST(Silhouette, BehindTheSensorDoesNotWrapRound) {
  const Silhouette s = SilhouetteOf({{-20.0, 0.0}, 0.0, 4.0, 2.0}, kHere);
  EXPECT_NEAR(std::abs(s.middle_rad), kPi, 1e-9);
  EXPECT_NEAR(s.half_width_rad, std::atan2(1.0, 18.0), 1e-9);
}

TEST(Silhouette, OfTheBoxRoundThePointIsEverywhere) {
  EXPECT_EQ(SilhouetteOf({{0.5, 0.0}, 0.3, 4.0, 2.0}, kHere).half_width_rad, kPi);
}

TEST(UncoveredShares, ANearerBoxCoversWhatItOverlaps) {
  // Directions -0.1..0.1; a nearer one over -0.2..0.05, another one further away over all of it.
  const std::vector<double> shares =
      UncoveredShares({{0.0, 0.1, 30.0}, {-0.075, 0.125, 10.0}, {0.0, 0.5, 50.0}});
  EXPECT_NEAR(shares[0], 0.25, 1e-12);
  EXPECT_NEAR(shares[1], 1.0, 1e-12);
  EXPECT_NEAR(shares[2], 1.0 - 0.3, 1e-12);  // -0.2..0.1 of -0.5..0.5 are covered once.
}

TEST(UncoveredShares, HoldAcrossTheBackDirection) {
  const std::vector<double> shares = UncoveredShares({{kPi, 0.1, 30.0}, {-kPi + 0.05, 0.1, 10.0}});
  EXPECT_NEAR(shares[0], 0.25, 1e-9);
}

}  // namespace
}  // namespace v2vouch::evaluation
