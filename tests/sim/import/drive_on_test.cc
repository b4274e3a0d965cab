// SPDX-License-Identifier: Apache-2.0
#include "sim/import/drive_on.h"

#include <gtest/gtest.h>

#include <cmath>

namespace v2vouch::sim {
namespace {

// Drives east along `y_m` from `x_m` on, between the two times.
std::vector<CentreSample> East(double from_s, double to_s, double x_m, double y_m,
                               double speed_mps) {
  std::vector<CentreSample> motion;
  const int rows = static_cast<int>(std::lround(10.0 * (to_s - from_s)));
  for (int k = 0; k <= rows; ++k) {
    motion.push_back({from_s + 0.1 * k, {x_m + 0.1 * k * speed_mps, y_m}, 0.0, speed_mps});
  }
  return motion;
}

double StepsAreThoseOfAVehicle(const std::vector<CentreSample>& motion) {
  double worst_mps2 = 0.0;
  for (std::size_t k = 1; k < motion.size(); ++k) {
    EXPECT_NEAR(motion[k].time_s - motion[k - 1].time_s, 0.1, 1e-6);
    EXPECT_NEAR((motion[k].centre - motion[k - 1].centre).norm(), 0.1 * motion[k].speed_mps, 1e-6);
    worst_mps2 =
        std::max(worst_mps2, std::abs(motion[k].speed_mps - motion[k - 1].speed_mps) / 0.1);
  }
  return worst_mps2;
}

TEST(DriveOn, AVehicleThatLeavesTheNetGoesOnAsItDroveUntilTheEnd) {
  std::vector<std::vector<CentreSample>> motions = {East(0.0, 20.0, 0.0, 0.0, 0.0),
                                                    East(0.0, 8.0, 20.0, 3.5, 5.0)};
  DriveOn(motions, std::vector<FcdBody>(2), 0, 20.0, 150.0);
  EXPECT_NEAR(motions[1].back().time_s, 20.0, 0.1);
  EXPECT_NEAR(motions[1].back().centre.x(), 20.0 + 20.0 * 5.0, 1.0);
  EXPECT_NEAR(motions[1].back().centre.y(), 3.5, 1e-9);
  EXPECT_LT(StepsAreThoseOfAVehicle(motions[1]), 0.01);
  EXPECT_EQ(motions[0].size(), 201u) << "the ego stays as recorded";
}

TEST(DriveOn, ItEndsOutOfSight) {
  std::vector<std::vector<CentreSample>> motions = {East(0.0, 60.0, 0.0, 0.0, 0.0),
                                                    East(0.0, 8.0, 20.0, 3.5, 10.0)};
  DriveOn(motions, std::vector<FcdBody>(2), 0, 60.0, 150.0);
  EXPECT_NEAR(motions[1].back().centre.x(), 151.0, 2.0);
}

TEST(DriveOn, AFasterOneThatLeavesLaterKeepsBehind) {
  std::vector<std::vector<CentreSample>> motions = {East(0.0, 60.0, 0.0, 0.0, 0.0),
                                                    East(0.0, 8.0, 20.0, 3.5, 6.0),
                                                    East(0.0, 10.0, -70.0, 3.5, 13.0)};
  DriveOn(motions, std::vector<FcdBody>(3), 0, 40.0, 400.0);
  const auto& first = motions[1];
  const auto& second = motions[2];
  ASSERT_GT(second.back().time_s, 39.0);
  for (std::size_t k = 0; k < std::min(first.size(), second.size()); ++k) {
    EXPECT_GT(first[k].centre.x() - second[k].centre.x(), 4.3 + 0.5) << first[k].time_s;
  }
  EXPECT_LT(StepsAreThoseOfAVehicle(second), 6.1);
}

TEST(DriveOn, OneThatStandsAtTheEdgeMovesOffSoThatOthersMayFollow) {
  std::vector<std::vector<CentreSample>> motions = {East(0.0, 30.0, 0.0, 0.0, 0.0),
                                                    East(0.0, 8.0, 60.0, 3.5, 0.0)};
  DriveOn(motions, std::vector<FcdBody>(2), 0, 20.0, 150.0);
  EXPECT_NEAR(motions[1].back().speed_mps, 5.0, 1e-9);
  EXPECT_LT(StepsAreThoseOfAVehicle(motions[1]), 1.6);
}

TEST(DriveOn, OneThatLeftLongBeforeTheEgoCameIsNotCarriedRoundTheWorld) {
  std::vector<std::vector<CentreSample>> motions = {East(1000.0, 1020.0, 0.0, 0.0, 0.0),
                                                    East(0.0, 8.0, 20.0, 3.5, 10.0)};
  DriveOn(motions, std::vector<FcdBody>(2), 0, 1020.0, 150.0);
  EXPECT_LT(motions[1].size(), 300u);
}

}  // namespace
}  // namespace v2vouch::sim
