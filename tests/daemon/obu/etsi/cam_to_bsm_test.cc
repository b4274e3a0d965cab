// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/etsi/cam_to_bsm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "daemon/obu/ieee1609/dot2_time.h"

namespace v2vouch::obu {
namespace {

// As the captured frame: 4.2 m long, heading 72.4 degrees.
Cam Sample() {
  Cam cam;
  cam.station_id = 2624309139;
  cam.generation_delta_time = 9983;
  cam.station_type = 5;
  cam.latitude = 535505166;
  cam.longitude = 99353789;
  cam.semi_major = 195;
  cam.semi_minor = 195;
  cam.orientation = 900;
  cam.altitude = 12230;
  cam.heading = 724;
  cam.speed = 1100;
  cam.direction = 0;
  cam.length = 42;
  cam.width = 18;
  cam.accel_long = -1;
  cam.yaw_rate = 150;
  cam.accel_lateral = 7;
  cam.accel_vertical = 2;
  cam.steering_angle = 4;
  return cam;
}

// Displacement of the core against the CAM, metres east and north on the ellipsoid's local radii.
struct Shift {
  double east_m;
  double north_m;
};
Shift ShiftOf(const Cam& cam, const BsmCore& core) {
  const double lat_rad = cam.latitude * 1e-7 * std::numbers::pi / 180.0;
  // Metres per degree, series of the ellipsoid (NIMA).
  const double north = 111132.92 - 559.82 * std::cos(2 * lat_rad) + 1.175 * std::cos(4 * lat_rad);
  const double east = 111412.84 * std::cos(lat_rad) - 93.5 * std::cos(3 * lat_rad);
  return {(core.lon - cam.longitude) * 1e-7 * east, (core.lat - cam.latitude) * 1e-7 * north};
}

// Failure mode 21.
TEST(CoreOfCam, FrontCentreMovesBackToTheCentreOfTheFootprint) {
  const Cam cam = Sample();
  const Shift shift = ShiftOf(cam, CoreOfCam(cam, {}));
  const double heading = 72.4 * std::numbers::pi / 180.0;
  EXPECT_NEAR(shift.east_m, -2.1 * std::sin(heading), 0.012);
  EXPECT_NEAR(shift.north_m, -2.1 * std::cos(heading), 0.012);
}

TEST(CoreOfCam, InReverseTheBodyPointsAgainstTheMotion) {
  Cam cam = Sample();
  cam.direction = 1;
  const Shift shift = ShiftOf(cam, CoreOfCam(cam, {}));
  const double heading = 72.4 * std::numbers::pi / 180.0;
  EXPECT_NEAR(shift.east_m, 2.1 * std::sin(heading), 0.012);
  EXPECT_NEAR(shift.north_m, 2.1 * std::cos(heading), 0.012);
}

TEST(CoreOfCam, UnknownLengthOrAxisGoesIntoTheAccuracy) {
  Cam cam = Sample();
  const BsmCore exact = CoreOfCam(cam, {});
  EXPECT_EQ(exact.semi_major, 16);  // 1.95 m / 2.4477 = 0.797 m.
  cam.length = 1023;
  const BsmCore no_length = CoreOfCam(cam, {});
  EXPECT_EQ(no_length.length, 0);
  EXPECT_NEAR(std::hypot(ShiftOf(cam, no_length).east_m, ShiftOf(cam, no_length).north_m), 2.3,
              0.012);
  EXPECT_EQ(no_length.semi_major, 62);  // + 2.3 m.
  cam = Sample();
  cam.heading = 3601;
  const BsmCore no_axis = CoreOfCam(cam, {});
  EXPECT_EQ(no_axis.lat, cam.latitude);
  EXPECT_EQ(no_axis.heading, 28800);
  EXPECT_EQ(no_axis.semi_major, 58);  // + 2.1 m.
  EXPECT_EQ(no_axis.semi_minor, 58);
}

TEST(CoreOfCam, SignsAndUnitsAreThoseOfJ2735) {
  const BsmCore core = CoreOfCam(Sample(), {});
  EXPECT_EQ(core.id, 2624309139u);
  EXPECT_EQ(core.speed, 550);
  EXPECT_EQ(core.heading, 5792);  // 72.4 degrees.
  EXPECT_EQ(core.elev, 1223);
  EXPECT_EQ(core.transmission, 2);
  EXPECT_EQ(core.accel_long, -10);
  EXPECT_EQ(core.accel_lat, -70);  // Left positive there, right positive here.
  EXPECT_EQ(core.accel_yaw, -150);
  EXPECT_EQ(core.angle, -4);
  EXPECT_EQ(core.accel_vert, 1);  // 0.2 m/s^2 in 0.02 g.
  EXPECT_EQ(core.width, 180);
  EXPECT_EQ(core.length, 420);
  EXPECT_EQ(core.orientation, 16384);
  EXPECT_EQ(core.wheel_brakes, 16);
}

// Failure mode 7 for CAMs: each code alone.
TEST(CoreOfCam, UnavailableStaysUnavailable) {
  const BsmCore none = CoreOfCam(Cam{}, {});
  const BsmCore wanted;
  for (const CoreField& field : CoreFields()) {
    EXPECT_EQ(none.*field.member, wanted.*field.member) << field.name;
  }
}

TEST(CoreOfCam, TimeOfThePositionIsUnwrappedRoundTheReception) {
  Cam cam = Sample();
  const std::int64_t rx_utime = 1700000000000000;
  // Positions 30 ms before, just now, and 3 s after by a clock that is ahead.
  for (const std::int64_t offset_us : {-30000, 0, 3000000, -20000000}) {
    const std::int64_t position = rx_utime + offset_us;
    cam.generation_delta_time = static_cast<int>(Dot2MicrosOfUtc(position) / 1000 % 65536);
    EXPECT_EQ(PositionTime(cam, rx_utime), position);
    EXPECT_EQ(CoreOfCam(cam, rx_utime).sec_mark, position / 1000 % 60000);
  }
  EXPECT_EQ(CoreOfCam(cam, {}).sec_mark, 65535);
}

TEST(CoreOfCam, DateLineAndPolesStayInRange) {
  Cam cam = Sample();
  cam.heading = 2700;
  cam.longitude = 1799999999;
  EXPECT_LT(CoreOfCam(cam, {}).lon, -1799999000);
  cam.longitude = -1800000000;
  cam.heading = 900;
  EXPECT_GT(CoreOfCam(cam, {}).lon, 1799999000);
  cam.latitude = 900000000;
  const BsmCore pole = CoreOfCam(cam, {});
  EXPECT_LE(pole.lat, 900000000);
  EXPECT_GE(pole.lon, -1799999999);
}

}  // namespace
}  // namespace v2vouch::obu
