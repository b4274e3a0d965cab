// SPDX-License-Identifier: Apache-2.0
#include "sim/world/geometry.h"

#include <gtest/gtest.h>

namespace v2vouch::sim {
namespace {

TEST(RayHitsSegment, MeetsAWallAtItsDistance) {
  const auto hit = RayHitsSegment({1, 2}, {1, 0}, {5, 0}, {5, 4});
  ASSERT_TRUE(hit.has_value());
  EXPECT_DOUBLE_EQ(*hit, 4.0);
}

TEST(RayHitsSegment, MissesBehindBesideAndAlong) {
  EXPECT_FALSE(RayHitsSegment({6, 2}, {1, 0}, {5, 0}, {5, 4}).has_value());
  EXPECT_FALSE(RayHitsSegment({1, 5}, {1, 0}, {5, 0}, {5, 4}).has_value());
  EXPECT_FALSE(RayHitsSegment({1, 0}, {1, 0}, {2, 0}, {4, 0}).has_value());
}

TEST(RayHitsOutline, FindsTheNearFace) {
  const Box box{{10, 0}, kPi / 2, 4.0, 2.0};  // Lies across: 2 m deep seen from the origin.
  const auto corners = box.Corners();
  const auto hit = RayHitsOutline({0, 0}, {1, 0}, {corners.begin(), corners.end()});
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(*hit, 9.0, 1e-12);
}

TEST(LineCrossesOutline, StopsShortOfTheWall) {
  const std::vector<Vec2> square = {{2, -1}, {4, -1}, {4, 1}, {2, 1}};
  EXPECT_TRUE(LineCrossesOutline({0, 0}, {6, 0}, square));
  EXPECT_FALSE(LineCrossesOutline({0, 0}, {1.9, 0}, square));
  EXPECT_FALSE(LineCrossesOutline({0, 2}, {6, 2}, square));
}

TEST(Box, PointsAndLocalCoordinatesAreInverse) {
  const Box box{{3, -2}, 0.7, 4.0, 2.0};
  const Vec2 local = box.Local(box.PointAt(1.3, -0.4));
  EXPECT_NEAR(local.x(), 1.3, 1e-12);
  EXPECT_NEAR(local.y(), -0.4, 1e-12);
  EXPECT_TRUE(box.Contains(box.PointAt(1.99, 0.99)));
  EXPECT_FALSE(box.Contains(box.PointAt(2.01, 0.0)));
}

TEST(Overlap, SeesTurnedBoxesApartThatAxisAlignedBoundsWouldNot) {
  const Box a{{0, 0}, kPi / 4, 4.0, 1.0};
  EXPECT_FALSE(Overlap(a, {{1.4, -1.4}, kPi / 4, 4.0, 1.0}));
  EXPECT_TRUE(Overlap(a, {{0.5, -0.5}, kPi / 4, 4.0, 1.0}));
}

}  // namespace
}  // namespace v2vouch::sim
