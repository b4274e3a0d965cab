// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/tiles.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

CameraBox Box(double left, double width, double score) {
  return {left, 100, width, 50, ObjectClass::kCar, score};
}

TEST(Tiles, CoverThePictureAndOverlap) {
  for (const int width : {1242, 1600, 33}) {
    for (const int count : {1, 2, 3, 8}) {
      const auto tiles = TilesOf(width, count, 0.2);
      ASSERT_EQ(tiles.size(), static_cast<std::size_t>(count));
      EXPECT_EQ(tiles.front().left_px, 0);
      EXPECT_EQ(tiles.back().left_px + tiles.back().width_px, width);
      for (std::size_t i = 1; i < tiles.size(); ++i) {
        const int shared = tiles[i - 1].left_px + tiles[i - 1].width_px - tiles[i].left_px;
        EXPECT_NEAR(shared, 0.2 * tiles[i].width_px, 2.0);
      }
    }
  }
}

TEST(Tiles, APartYieldsToTheWholeThatANeighbourSaw) {
  const auto tiles = TilesOf(1000, 2, 0.2);  // 0..556 and 444..1000.
  const auto merged = MergeTiles(tiles, {{Box(500, 56, 0.9)}, {Box(500, 120, 0.5)}}, 1000);
  ASSERT_EQ(merged.size(), 1u);
  EXPECT_EQ(merged[0].width_px, 120.0);
}

TEST(Tiles, TwoHalvesBecomeOne) {
  const auto tiles = TilesOf(1000, 2, 0.2);
  const auto merged = MergeTiles(tiles, {{Box(300, 256, 0.6)}, {Box(444, 300, 0.8)}}, 1000);
  ASSERT_EQ(merged.size(), 1u);
  EXPECT_EQ(merged[0].left_px, 300.0);
  EXPECT_EQ(merged[0].width_px, 444.0);
  EXPECT_EQ(merged[0].score, 0.8);
}

TEST(Tiles, VehiclesApartStayApart) {
  const auto tiles = TilesOf(1000, 2, 0.2);
  EXPECT_EQ(MergeTiles(tiles, {{Box(0, 50, 0.9)}, {Box(950, 50, 0.5)}}, 1000).size(), 2u);
  // At the picture's own border nothing is cut by a tile.
  EXPECT_EQ(MergeTiles(TilesOf(1000, 1, 0.2), {{Box(950, 50, 0.5)}}, 1000).size(), 1u);
}

}  // namespace
}  // namespace v2vouch
