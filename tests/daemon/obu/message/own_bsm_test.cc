// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/message/own_bsm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "daemon/obu/framing/datagram.h"
#include "tests/support/obu_samples.h"

namespace v2vouch::obu {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::int64_t kNow = 1700000047400000;

ego_motion_t Motion(double speed_mps = 10.0, double yaw_rate_radps = 0.0) {
  ego_motion_t motion{};
  motion.utime = kNow;
  motion.speed_mps = speed_mps;
  motion.yaw_rate_radps = yaw_rate_radps;
  motion.accel_long_mps2 = 1.5;
  motion.accel_lat_mps2 = 0.7;
  motion.gear = ego_motion_t::GEAR_FORWARD;
  return motion;
}

gnss_fix_t Fix(double heading_rad = 0.0) {
  gnss_fix_t fix{};
  fix.utime = kNow;
  fix.latitude_rad = 48.0 * kDegree;
  fix.longitude_rad = 11.0 * kDegree;
  fix.altitude_m = 512.3;
  fix.covariance_enu_m2[0] = 4.0;
  fix.covariance_enu_m2[4] = 1.0;
  fix.heading_rad = heading_rad;
  fix.heading_sigma_rad = 0.01;
  fix.velocity_east_mps = kNan;
  fix.velocity_north_mps = kNan;
  fix.fix_type = gnss_fix_t::FIX_3D;
  return fix;
}

OwnVehicle Car() {
  return {
      .antenna_x_m = 0.8, .antenna_y_m = 0.5, .centre_x_m = 1.4, .length_m = 4.7, .width_m = 1.85};
}

// Metres against 48 N 11 E (lengths of a degree there: 111200.0 m north, 74629 m east, WGS-84).
double North(const Bsm& bsm) { return (bsm.core.lat - 480000000) * 1e-7 * 111200.0; }
double East(const Bsm& bsm) { return (bsm.core.lon - 110000000) * 1e-7 * 74629.0; }

Bsm Made(const ego_motion_t& motion, const gnss_fix_t& fix, std::int64_t utime = kNow) {
  OwnBsm own(Car(), 1);
  own.OnMotion(motion);
  own.OnFix(fix);
  const auto bsm = own.Make(utime);
  EXPECT_TRUE(bsm);
  return bsm.value_or(Bsm{});
}

TEST(OwnBsm, PlaceIsTheCentreOfTheFootprintNotTheAntenna) {
  const Bsm north = Made(Motion(0.0), Fix(0.0));
  EXPECT_NEAR(North(north), 0.6, 0.012);
  EXPECT_NEAR(East(north), 0.5, 0.012);  // The antenna is left of the middle.
  const Bsm east = Made(Motion(0.0), Fix(90.0 * kDegree));
  EXPECT_NEAR(North(east), -0.5, 0.012);
  EXPECT_NEAR(East(east), 0.6, 0.012);
}

TEST(OwnBsm, PlaceAndSecMarkAreOfTheSameTime) {
  const Bsm bsm = Made(Motion(10.0), Fix(0.0), kNow + 80000);
  EXPECT_NEAR(North(bsm), 0.6 + 0.8, 0.012);
  EXPECT_EQ(bsm.core.sec_mark, (kNow + 80000) / 1000 % 60000);
}

TEST(OwnBsm, UnitsAndSignsAreThoseOfJ2735) {
  const Bsm bsm = Made(Motion(10.0, 0.2), Fix(90.0 * kDegree));
  const BsmCore& core = bsm.core;
  EXPECT_EQ(core.speed, 500);
  EXPECT_EQ(core.heading, 7200);
  EXPECT_EQ(core.accel_long, 150);
  EXPECT_EQ(core.accel_lat, -70);
  EXPECT_EQ(core.accel_yaw, -1146);  // Left turn, 11.46 degrees/s.
  EXPECT_EQ(core.elev, 5123);
  EXPECT_EQ(core.transmission, 2);
  EXPECT_EQ(core.semi_major, 40);
  EXPECT_EQ(core.semi_minor, 20);
  EXPECT_NEAR(core.orientation * 360.0 / 65535.0, 90.0, 0.01);  // Longer to the east.
  EXPECT_EQ(core.length, 470);
  EXPECT_EQ(core.width, 185);
}

TEST(OwnBsm, InReverseHeadingIsOfTheMotionAndSpeedHasNoSign) {
  ego_motion_t motion = Motion(-2.0);
  motion.gear = ego_motion_t::GEAR_REVERSE;
  const Bsm bsm = Made(motion, Fix(90.0 * kDegree));
  EXPECT_EQ(bsm.core.speed, 100);
  EXPECT_EQ(bsm.core.heading, 21600);
  EXPECT_EQ(bsm.core.transmission, 3);
}

// Never zeros for what is not known.
TEST(OwnBsm, UnknownFiguresSayUnavailable) {
  gnss_fix_t fix = Fix();
  fix.altitude_m = kNan;
  fix.heading_sigma_rad = 0.0;  // With a heading of 0: none.
  fix.covariance_enu_m2[0] = 0.0;
  OwnBsm own({}, 1);
  own.OnFix(fix);
  const auto bsm = own.Make(kNow);
  ASSERT_TRUE(bsm);
  BsmCore wanted;
  wanted.id = bsm->core.id;
  wanted.msg_count = bsm->core.msg_count;
  wanted.sec_mark = bsm->core.sec_mark;
  wanted.lat = 480000000;
  wanted.lon = 110000000;
  EXPECT_EQ(bsm->core, wanted);
}

TEST(OwnBsm, CourseOfAMovingCarComesFromItsVelocityAndIsKeptAtStandstill) {
  gnss_fix_t fix = Fix();
  fix.heading_rad = kNan;
  fix.velocity_east_mps = 5.0;
  fix.velocity_north_mps = 5.0;
  OwnBsm own(Car(), 1);
  own.OnFix(fix);
  own.OnMotion(Motion(7.0));
  EXPECT_EQ(own.Make(kNow)->core.heading, 3600);
  fix.velocity_east_mps = 0.1;
  fix.velocity_north_mps = -0.1;
  own.OnFix(fix);
  EXPECT_EQ(own.Make(kNow)->core.heading, 3600);
}

// Failure mode 13.
TEST(OwnBsm, NoFigureStopsTheStream) {
  std::mt19937_64 rng(13);
  const double odd[] = {kNan,
                        std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity(),
                        1e308,
                        -1e308,
                        0.0,
                        1e4};
  OwnBsm own(Car(), 1);
  int sent = 0;
  for (int i = 0; i < 500; ++i) {
    const auto any = [&] { return odd[rng() % std::size(odd)]; };
    ego_motion_t motion = Motion(any(), any());
    motion.accel_long_mps2 = any();
    motion.accel_lat_mps2 = any();
    motion.gear = static_cast<std::int8_t>(rng());
    gnss_fix_t fix = Fix(any());
    fix.altitude_m = any();
    fix.velocity_east_mps = any();
    fix.velocity_north_mps = any();
    for (double& value : fix.covariance_enu_m2) value = any();
    own.OnMotion(motion);
    own.OnFix(fix);
    const auto bsm = own.Make(kNow + i);
    ASSERT_TRUE(bsm);
    sent += DatagramOf(*bsm, OutputForm::kFrame).empty() ? 0 : 1;
  }
  EXPECT_EQ(sent, 500);
  EXPECT_GT(own.saturated(), 0);
}

TEST(OwnBsm, WithoutAFreshFixThereIsNoMessage) {
  OwnBsm own(Car(), 1);
  EXPECT_FALSE(own.Make(kNow));
  gnss_fix_t fix = Fix();
  fix.fix_type = gnss_fix_t::FIX_NONE;
  own.OnFix(fix);
  fix = Fix();
  fix.latitude_rad = fix.longitude_rad = 0.0;
  own.OnFix(fix);
  EXPECT_FALSE(own.Make(kNow));
  own.OnFix(Fix());
  EXPECT_TRUE(own.Make(kNow));
  EXPECT_FALSE(own.Make(kNow + 1600000));
}

TEST(OwnBsm, CountGoesUpByOneAndIdentityChangesWithItsCount) {
  OwnVehicle car = Car();
  car.id_change_us = 10000000;
  OwnBsm own(car, 7);
  std::optional<Bsm> last;
  int changes = 0;
  for (int i = 0; i < 350; ++i) {
    gnss_fix_t fix = Fix();
    fix.utime = kNow + i * 100000;
    own.OnFix(fix);
    const auto bsm = own.Make(fix.utime);
    ASSERT_TRUE(bsm);
    if (last && last->core.id == bsm->core.id) {
      EXPECT_EQ(bsm->core.msg_count, (last->core.msg_count + 1) % 128);
    } else if (last) {
      ++changes;
    }
    EXPECT_EQ(own.id(), bsm->core.id);
    last = bsm;
  }
  EXPECT_EQ(changes, 3);
}

TEST(DatagramOf, EveryFormIsReadBackByTheReader) {
  Bsm bsm = Made(Motion(), Fix());
  const Octets content(250, 0x5A);
  for (const std::size_t octets : {0u, 60u, 120u, 250u}) {
    bsm.part_two[0] = {5, {content, 0, octets * 8}};
    bsm.part_two_count = octets > 0 ? 1 : 0;
    for (const OutputForm form : {OutputForm::kFrame, OutputForm::kDot2, OutputForm::kRsuText}) {
      const auto bytes = DatagramOf(bsm, form, {.signs = true});
      Octets scratch(kLongestDatagram);
      Datagram datagram;
      ReadDatagram(bytes, {std::nullopt, true, 0}, scratch, datagram);
      ASSERT_FALSE(datagram.fault) << FaultText(datagram.fault);
      EXPECT_EQ(datagram.bsm->core, bsm.core);
    }
  }
  const auto text = DatagramOf(bsm, OutputForm::kRsuText, {.signs = true});
  const std::string lines(text.begin(), text.end());
  EXPECT_TRUE(lines.starts_with("Version=0.7\nType=BSM\nPSID=0x20\nPriority=6\n"));
  EXPECT_NE(lines.find("\nSignature=True\n"), std::string::npos);
}

}  // namespace
}  // namespace v2vouch::obu
