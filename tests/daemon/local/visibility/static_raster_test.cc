// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/visibility/static_raster.h"

#include <gtest/gtest.h>

#include <vector>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

Timestamp At(double seconds) { return FromMicros(1'000'000'000) + FromSeconds(seconds); }

struct Active {
  Eigen::Vector2d p_O;
  bool is_structure = false;
};

std::vector<Active> ActiveCells(const StaticRaster& raster, double seconds,
                                const Eigen::Vector2d& near_O = Eigen::Vector2d::Zero()) {
  std::vector<Active> cells;
  raster.ForEachActive(At(seconds), near_O, [&](const Eigen::Vector2d& p_O, bool is_structure) {
    cells.push_back({p_O, is_structure});
  });
  return cells;
}

TEST(StaticRaster, ACellNeedsItsHitsAndForgetsAfterTheHold) {
  StaticRaster raster(1.0, 2.0, 3);
  raster.Add(At(0.0), {20.4, -3.2});
  raster.Add(At(0.0), {20.6, -3.3});  // The same instant counts once.
  raster.Add(At(0.1), {20.5, -3.9});
  EXPECT_TRUE(ActiveCells(raster, 0.1).empty());
  raster.Add(At(0.2), {20.5, -3.1});
  const auto cells = ActiveCells(raster, 2.2);
  ASSERT_EQ(cells.size(), 1U);
  EXPECT_EQ(cells[0].p_O, Eigen::Vector2d(20.5, -3.5));
  EXPECT_FALSE(cells[0].is_structure);
  EXPECT_TRUE(ActiveCells(raster, 2.3).empty());
  raster.Add(At(3.0), {20.5, -3.5});  // After the silence it starts again.
  EXPECT_TRUE(ActiveCells(raster, 3.0).empty());
}

TEST(StaticRaster, AWallIsAStructureAPoleIsNot) {
  StaticRaster raster(1.0, 2.0, 3);
  for (int scan = 0; scan < 5; ++scan) {
    for (double x = 0.5; x < 12.0; x += 1.0) raster.Add(At(0.05 * scan), {x, 30.5});
    raster.Add(At(0.05 * scan), {10.5, 10.5});
    raster.Add(At(0.05 * scan), {11.5, 10.5});  // The pole's returns scatter.
  }
  int wall = 0;
  for (const Active& cell : ActiveCells(raster, 0.2)) {
    EXPECT_EQ(cell.is_structure, cell.p_O.y() > 20.0) << cell.p_O.transpose();
    wall += cell.is_structure ? 1 : 0;
  }
  EXPECT_EQ(wall, 12);
}

TEST(StaticRaster, FarAwayPlacesKeepTheirCoordinates) {
  StaticRaster raster(1.0, 2.0, 1);
  const Eigen::Vector2d place(-123456.5, 70000.5);  // Keys wrap every 65536 cells.
  raster.Add(At(0.0), place);
  const auto cells = ActiveCells(raster, 0.0, place + Eigen::Vector2d(-150.0, 90.0));
  ASSERT_EQ(cells.size(), 1U);
  EXPECT_EQ(cells[0].p_O, place);
}

TEST(StaticRaster, OverflowDropsTheOldestAndKeepsTheNewest) {
  StaticRaster raster(1.0, 100.0, 1);
  Random random(2);
  std::vector<Eigen::Vector2d> added;
  for (int i = 0; i < 5000; ++i) {
    added.emplace_back(std::floor(random.Uniform(-200.0, 200.0)) + 0.5,
                       std::floor(random.Uniform(-200.0, 200.0)) + 0.5);
    raster.Add(At(0.001 * i), added.back());
  }
  const auto cells = ActiveCells(raster, 5.0);
  EXPECT_LE(cells.size(), 768U);
  EXPECT_GE(cells.size(), 700U);
  const auto holds = [&](const Eigen::Vector2d& p) {
    for (const Active& cell : cells) {
      if (cell.p_O == p) return true;
    }
    return false;
  };
  int newest = 0;
  for (std::size_t i = added.size() - 100; i < added.size(); ++i) newest += holds(added[i]) ? 1 : 0;
  EXPECT_EQ(newest, 100);
}

// A rail that a vehicle was measured through hides nothing there any more, and the rest of it
// keeps what does not depend on those cells.
TEST(StaticRaster, WhatWasSeenThroughIsNoLongerActive) {
  StaticRaster raster(1.0, 2.0, 3);
  const auto fill = [&](double from_s) {
    for (int scan = 0; scan < 3; ++scan) {
      for (int x = 10; x < 30; ++x) raster.Add(At(from_s + 0.05 * scan), {x + 0.5, 5.5});
    }
  };
  fill(0.0);
  ASSERT_EQ(ActiveCells(raster, 0.2).size(), 20U);
  raster.SeeThrough({0.0, 0.0}, {40.0, 11.0});  // Crosses y = 5..6 at x = 18.2..21.8.
  const auto left = ActiveCells(raster, 0.2);
  EXPECT_EQ(left.size(), 16U);
  for (const Active& cell : left) {
    EXPECT_TRUE(cell.p_O.x() < 18.0 || cell.p_O.x() > 22.0) << cell.p_O.x();
  }
  fill(0.3);  // Further hits do not make it opaque again ...
  EXPECT_EQ(ActiveCells(raster, 0.5).size(), 16U);
  fill(3.0);  // ... but a new beginning does.
  EXPECT_EQ(ActiveCells(raster, 3.2).size(), 20U);
}

}  // namespace
}  // namespace v2vouch
