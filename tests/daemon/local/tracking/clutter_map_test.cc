// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/clutter_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

RadarMeasurement At(double range_m, double azimuth_rad, double rate_mps, int radar = 0) {
  RadarMeasurement z;
  z.radar = radar;
  z.range_m = range_m;
  z.azimuth_rad = azimuth_rad;
  z.ground_range_rate_mps = rate_mps;
  return z;
}

TEST(ClutterMap, WhatCameToNothingIsTheDensityOfItsCell) {
  const RadarConfig radar;  // +-60 degrees, 0.5 to 80 m.
  ClutterMap map(2);
  for (int scan = 0; scan < 100; ++scan) map.Age(0);  // Of which 79 are remembered.
  const RadarMeasurement drop = At(15.0, 0.1, 1.0);
  EXPECT_EQ(map.DensityAt(radar, drop), 0.0);
  map.Count(ClutterMap::CellOf(radar, drop), 53);
  // 53 clusters, of which three are a vehicle's own false starts, in a cell of 10 m, 30 degrees and
  // 4 m/s.
  const double scans = 200.0 * (1.0 - std::pow(1.0 - 1.0 / 200.0, 100));
  EXPECT_NEAR(map.DensityAt(radar, drop), 50.0 / scans / (10.0 * FromDegrees(30.0) * 4.0), 1e-5);
  EXPECT_GT(map.DensityAt(radar, At(12.0, 0.3, -1.5)), 0.0);
  EXPECT_EQ(map.DensityAt(radar, At(25.0, 0.1, 1.0)), 0.0);
  EXPECT_EQ(map.DensityAt(radar, At(15.0, -0.1, 1.0)), 0.0);
  EXPECT_EQ(map.DensityAt(radar, At(15.0, 0.1, 5.0)), 0.0);
  EXPECT_EQ(map.DensityAt(radar, At(15.0, 0.1, 1.0, 1)), 0.0);
}

TEST(ClutterMap, AFewFalseStartsOfAVehicleAreNoClutter) {
  const RadarConfig radar;
  ClutterMap map(1);
  const RadarMeasurement z = At(40.0, 0.0, 10.0);
  map.Count(ClutterMap::CellOf(radar, z), 1);
  map.Count(ClutterMap::CellOf(radar, z), 2);
  EXPECT_EQ(map.DensityAt(radar, z), 0.0);
}

TEST(ClutterMap, ForgetsWhenTheRainHasStopped) {
  const RadarConfig radar;
  ClutterMap map(1);
  const RadarMeasurement drop = At(15.0, 0.1, 1.0);
  map.Count(ClutterMap::CellOf(radar, drop), 50);
  EXPECT_GT(map.DensityAt(radar, drop), 0.0);
  for (int scan = 0; scan < 600; ++scan) map.Age(0);
  EXPECT_EQ(map.DensityAt(radar, drop), 0.0);
}

TEST(ClutterMap, EveryMeasurementHasACellOfItsRadar) {
  const RadarConfig radar;
  ClutterMap map(3);
  for (const double range : {0.0, 10.0, 79.0, 1e6}) {
    for (const double azimuth : {-4.0, -1.0, 0.0, 1.0, 4.0}) {
      for (const double rate : {-1e3, -2.0, 0.0, 2.0, 1e3}) {
        const RadarMeasurement z = At(range, azimuth, rate, 2);
        map.Count(ClutterMap::CellOf(radar, z), 1);
        EXPECT_GE(map.DensityAt(radar, z), 0.0);
      }
    }
  }
  map.Count(-1, 100);  // None.
}

}  // namespace
}  // namespace v2vouch
