// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/geodesy/curvature.h"

#include <gtest/gtest.h>

#include <GeographicLib/Geodesic.hpp>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

TEST(RadiiAt, AgreeWithGeographicLibToOneMillimetreOverTenMetres) {
  const GeographicLib::Geodesic& wgs84 = GeographicLib::Geodesic::WGS84();
  for (const double latitude_deg : {-80.0, -33.9, 0.0, 10.0, 48.7, 60.0, 85.0}) {
    const CurvatureRadii radii = RadiiAt(FromDegrees(latitude_deg));
    const double north_deg = ToDegrees(10.0 / radii.meridian_m);
    const double east_deg = ToDegrees(10.0 / radii.parallel_m);
    double north_m = 0.0;
    double east_m = 0.0;
    wgs84.Inverse(latitude_deg, 9.0, latitude_deg + north_deg, 9.0, north_m);
    wgs84.Inverse(latitude_deg, 9.0, latitude_deg, 9.0 + east_deg, east_m);
    EXPECT_NEAR(north_m, 10.0, 1e-3) << latitude_deg;
    EXPECT_NEAR(east_m, 10.0, 1e-3) << latitude_deg;
  }
}

TEST(RadiiAt, CanBeDividedByAtThePoles) {
  EXPECT_GT(RadiiAt(kPi / 2.0).parallel_m, 1.0);
  EXPECT_GT(RadiiAt(-kPi / 2.0).parallel_m, 1.0);
}

}  // namespace
}  // namespace v2vouch
