// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/local/visibility/visibility.h"

namespace v2vouch {
namespace {

// The sector that holds a body azimuth given in degrees.
const SectorHealth& At(const std::vector<SectorHealth>& sectors, double degrees) {
  for (const SectorHealth& sector : sectors) {
    if (ToDegrees(sector.from_rad) <= degrees && degrees < ToDegrees(sector.to_rad)) return sector;
  }
  ADD_FAILURE() << "no sector at " << degrees;
  return sectors.front();
}

TEST(Sectors, TwelveSectorsCloseTheCircle) {
  const VisibilityMap map({}, {});
  const auto sectors = map.Sectors(std::vector<char>{1, 1, 1, 1});
  ASSERT_EQ(sectors.size(), 12U);
  EXPECT_DOUBLE_EQ(sectors.front().from_rad, -kPi);
  EXPECT_NEAR(sectors.back().to_rad, kPi, 1e-12);
  for (std::size_t i = 1; i < 12; ++i) {
    EXPECT_NEAR(sectors[i].from_rad, sectors[i - 1].to_rad, 1e-12);
  }
}

TEST(Sectors, TheShippedVehicleWatchesFrontAndSidesAndIsBlindBehind) {
  const VisibilityMap map({}, {});
  const auto sectors = map.Sectors(std::vector<char>{1, 1, 1, 1});
  EXPECT_EQ(At(sectors, 10.0).state, SectorState::kWatched);
  EXPECT_DOUBLE_EQ(At(sectors, 10.0).range_m, 160.0);
  EXPECT_EQ(At(sectors, -70.0).state, SectorState::kWatched);  // Radar alone is mounted there.
  EXPECT_DOUBLE_EQ(At(sectors, -70.0).range_m, 80.0);
  EXPECT_EQ(At(sectors, 175.0).state, SectorState::kBlind);
  EXPECT_EQ(At(sectors, -175.0).state, SectorState::kBlind);
  EXPECT_DOUBLE_EQ(At(sectors, 175.0).range_m, 0.0);
}

TEST(Sectors, ADeadSensorShows) {
  const VisibilityMap map({}, {});
  const auto no_camera = map.Sectors(std::vector<char>{1, 1, 1, 0});
  EXPECT_EQ(At(no_camera, 10.0).state, SectorState::kDegraded);
  EXPECT_EQ(At(no_camera, 70.0).state, SectorState::kWatched);
  const auto no_right = map.Sectors(std::vector<char>{1, 1, 0, 1});
  EXPECT_EQ(At(no_right, -70.0).state, SectorState::kBlind);
  EXPECT_EQ(At(no_right, 70.0).state, SectorState::kWatched);
  const auto camera_only = map.Sectors(std::vector<char>{0, 0, 0, 1});
  EXPECT_EQ(At(camera_only, -10.0).state, SectorState::kDegraded);
  EXPECT_DOUBLE_EQ(At(camera_only, -10.0).range_m, 120.0);
  // The far radar is dead, the near one still looks ahead: the range says so.
  const auto no_front = map.Sectors(std::vector<char>{0, 1, 1, 0});
  EXPECT_DOUBLE_EQ(At(no_front, 10.0).range_m, 80.0);
  const auto none = map.Sectors({});
  for (const SectorHealth& sector : none) EXPECT_EQ(sector.state, SectorState::kBlind);
}

}  // namespace
}  // namespace v2vouch
