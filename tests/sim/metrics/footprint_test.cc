// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/footprint.h"

#include <gtest/gtest.h>

#include "daemon/common/base/angle.h"

namespace v2vouch::evaluation {
namespace {

using Vec2 = Eigen::Vector2d;

TEST(Footprint, DistanceIsZeroInsideAndToTheNearestEdgeOrCornerOutside) {
  const Footprint box{{10.0, 5.0}, kPi / 2.0, 4.0, 2.0};  // Stands north: x 9..11, y 3..7.
  EXPECT_DOUBLE_EQ(box.DistanceTo({10.5, 6.5}), 0.0);
  EXPECT_NEAR(box.DistanceTo({13.0, 5.0}), 2.0, 1e-12);
  EXPECT_NEAR(box.DistanceTo({14.0, 11.0}), 5.0, 1e-12);  // 3 and 4 from the corner.
}

TEST(Footprint, LineMeetsABoxItCrossesAndNotOneItPasses) {
  const Footprint box{{10.0, 0.0}, 0.0, 4.0, 2.0};
  EXPECT_TRUE(LineMeets(Vec2(0.0, 0.0), Vec2(20.0, 0.5), box));
  EXPECT_FALSE(LineMeets(Vec2(0.0, 0.0), Vec2(20.0, 4.0), box));
  EXPECT_FALSE(LineMeets(Vec2(0.0, 0.0), Vec2(7.9, 0.0), box));  // Ends in front of it.
}

TEST(Footprint, OverlapShareIsOfTheSmallerBox) {
  const Footprint a{{0.0, 0.0}, 0.0, 4.0, 2.0};
  EXPECT_NEAR(OverlapShare(a, a), 1.0, 1e-12);
  EXPECT_NEAR(OverlapShare(a, {{2.0, 0.0}, 0.0, 4.0, 2.0}), 0.5, 1e-12);
  EXPECT_NEAR(OverlapShare(a, {{0.0, 0.0}, kPi / 2.0, 10.0, 1.0}), 0.25, 1e-12);  // 2 of 8.
  EXPECT_NEAR(OverlapShare({{0.0, 0.0}, kPi / 4.0, 1.0, 1.0}, a), 1.0, 1e-12);    // Inside.
  EXPECT_DOUBLE_EQ(OverlapShare(a, {{9.0, 0.0}, 0.0, 4.0, 2.0}), 0.0);
  EXPECT_DOUBLE_EQ(OverlapShare(a, {{0.0, 0.0}, 0.0, 0.0, 2.0}), 0.0);
}

}  // namespace
}  // namespace v2vouch::evaluation
