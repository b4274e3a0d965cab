// SPDX-License-Identifier: Apache-2.0
// What drivers really send: figures that are unknown (0, NaN), that cannot be, or that are in
// another unit. One of them costs itself alone; what a message cannot do without refuses it by
// name.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/rim/wire/bsm_conversion.h"
#include "daemon/rim/wire/field_judge.h"
#include "daemon/rim/wire/sensor_conversion.h"

namespace v2vouch::wire {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr std::int64_t kUtime = 1'700'000'000'000'000;
constexpr Timestamp kReceived = FromMicros(kUtime + 30'000);

ego_motion_t Ego() {
  ego_motion_t ego{};
  ego.utime = kUtime;
  ego.speed_mps = 10.0;
  ego.speed_sigma_mps = 0.07;
  ego.yaw_rate_radps = 0.2;
  ego.yaw_rate_sigma_radps = 0.01;
  ego.accel_long_mps2 = 1.0;
  ego.accel_lat_mps2 = 0.5;
  ego.gear = 2;
  return ego;
}

gnss_fix_t Fix() {
  gnss_fix_t fix{};
  fix.utime = kUtime;
  fix.latitude_rad = 0.8;
  fix.longitude_rad = -0.1;
  fix.altitude_m = 100.0;
  fix.covariance_enu_m2[0] = 4.0;
  fix.covariance_enu_m2[1] = fix.covariance_enu_m2[3] = 1.0;
  fix.covariance_enu_m2[4] = 9.0;
  fix.covariance_enu_m2[8] = 16.0;
  fix.heading_rad = kPi / 2.0;  // East.
  fix.heading_sigma_rad = 0.01;
  fix.velocity_east_mps = 3.0;
  fix.velocity_north_mps = 4.0;
  fix.velocity_up_mps = kNaN;
  fix.velocity_sigma_mps = 0.1;
  fix.fix_type = 3;
  return fix;
}

bsm_t RawBsm() {
  bsm_t bsm{};
  bsm.rx_utime = kUtime;
  bsm.id[3] = 1;
  bsm.msgCnt = 5;
  bsm.secMark = 20000;
  bsm.lat = 509380000;
  bsm.long_ = 69570000;
  bsm.elev = 1000;
  bsm.semiMajor = bsm.semiMinor = 40;
  bsm.orientation = 0;
  bsm.transmission = 2;
  bsm.speed = 500;
  bsm.heading = 7200;
  bsm.angle = 0;
  bsm.accelSet_yaw = 100;
  bsm.length = 450;
  bsm.width = 180;
  bsm.rssi_dbm = -70.0F;
  return bsm;
}

radar_scan_t Scan() {
  radar_scan_t scan{};
  scan.utime = kUtime;
  scan.sensor = "FRONT";
  scan.detections = {{20.0, 0.2, -5.0, 10.0, 15.0, 7}};
  scan.num_detections = 1;
  return scan;
}

camera_detections_t Boxes() {
  camera_detections_t boxes{};
  boxes.utime = kUtime;
  boxes.sensor = "FRONT";
  boxes.image_width_px = 1280;
  boxes.image_height_px = 720;
  boxes.boxes = {{1.0, 2.0, 30.0, 40.0, 2, "car", 0.9}};
  boxes.num_boxes = 1;
  return boxes;
}

EgoMotion TakenEgo(const ego_motion_t& message, RefusalTally& unused) {
  const auto ego = FromWire(message, VehicleConfig{}, kReceived, unused);
  EXPECT_TRUE(ego) << ReasonName(ego.reason()) << " " << ego.refusal().field;
  return ego ? *ego : EgoMotion{};
}

GnssFix TakenFix(const gnss_fix_t& message, RefusalTally& unused) {
  const auto fix = FromWire(message, VehicleConfig{}, kReceived, unused);
  EXPECT_TRUE(fix) << ReasonName(fix.reason()) << " " << fix.refusal().field;
  return fix ? *fix : GnssFix{};
}

TEST(UnknownEgoFigures, ASigmaThatIsNoneIsTheDocumentedDefault) {
  for (const double none : {0.0, -0.0, kNaN, -1.0, kInf, 1e9}) {
    ego_motion_t message = Ego();
    message.speed_sigma_mps = message.yaw_rate_sigma_radps = none;
    message.accel_long_sigma_mps2 = message.accel_lat_sigma_mps2 = none;
    RefusalTally unused;
    const EgoMotion ego = TakenEgo(message, unused);
    EXPECT_DOUBLE_EQ(ego.speed_sigma_mps, EgoMotion{}.speed_sigma_mps) << none;
    EXPECT_DOUBLE_EQ(ego.yaw_rate_sigma_radps, EgoMotion{}.yaw_rate_sigma_radps) << none;
    EXPECT_EQ(ego.yaw_rate_radps, 0.2);
    // 0 and NaN are documented; the others are told.
    const bool is_documented = std::isnan(none) || none == 0.0;
    EXPECT_EQ(unused.CountOf({Reason::kFieldUnused, "speed_sigma_mps"}), is_documented ? 0u : 1u);
  }
}

TEST(UnknownEgoFigures, AccelerationsAndGearCostThemselvesAlone) {
  for (const double none : {kNaN, kInf, -kInf, 1e6}) {
    ego_motion_t message = Ego();
    message.accel_long_mps2 = message.accel_lat_mps2 = none;
    RefusalTally unused;
    const EgoMotion ego = TakenEgo(message, unused);
    EXPECT_FALSE(ego.accel_long_mps2 || ego.accel_lat_mps2) << none;
    EXPECT_EQ(ego.speed_mps, 10.0);
  }
  for (int gear = -128; gear < 128; ++gear) {
    ego_motion_t message = Ego();
    message.gear = static_cast<std::int8_t>(gear);
    RefusalTally unused;
    const EgoMotion ego = TakenEgo(message, unused);
    const bool is_known = gear >= 0 && gear <= 3;
    EXPECT_EQ(static_cast<int>(ego.gear), is_known ? gear : 7);
    EXPECT_EQ(unused.CountOf({Reason::kFieldUnused, "gear"}), is_known || gear == 7 ? 0u : 1u);
  }
}

TEST(UnknownEgoFigures, AnUnknownYawRateIsSaidToBeUnknown) {
  for (const double none : {kNaN, kInf, 1e9}) {
    ego_motion_t message = Ego();
    message.yaw_rate_radps = none;
    RefusalTally unused;
    const EgoMotion ego = TakenEgo(message, unused);
    EXPECT_FALSE(ego.has_yaw_rate);
    EXPECT_EQ(ego.yaw_rate_radps, 0.0);
    EXPECT_GE(ego.yaw_rate_sigma_radps, 0.1);
  }
}

TEST(UnknownEgoFigures, WithoutASpeedThereIsNothing) {
  for (const double none : {kNaN, kInf, 121.0}) {
    ego_motion_t message = Ego();
    message.speed_mps = none;
    RefusalTally unused;
    const auto ego = FromWire(message, VehicleConfig{}, kReceived, unused);
    ASSERT_FALSE(ego);
    EXPECT_EQ(ego.refusal().field, "speed_mps");
  }
}

TEST(UnknownCounters, AnyCounterIsTaken) {
  for (const std::int64_t seq : {std::int64_t{-1}, std::int64_t{0}, INT64_MIN, INT64_MAX}) {
    RefusalTally unused;
    ego_motion_t ego = Ego();
    ego.seq = seq;
    EXPECT_EQ(std::signbit(static_cast<double>(TakenEgo(ego, unused).seq)), seq < 0);
    gnss_fix_t fix = Fix();
    fix.seq = seq;
    TakenFix(fix, unused);
    radar_scan_t scan = Scan();
    scan.seq = seq;
    EXPECT_TRUE(FromWire(scan, RadarConfig{}, 0, kReceived, unused));
    camera_detections_t boxes = Boxes();
    boxes.seq = seq;
    EXPECT_TRUE(FromWire(boxes, CameraConfig{}, 0, kReceived, unused));
    bsm_t bsm = RawBsm();
    bsm.seq = seq;
    EXPECT_TRUE(FromWire(bsm, kReceived, unused));
    EXPECT_TRUE(unused.entries().empty());
  }
  // Differences of any two cannot overflow.
  EXPECT_GT(SafeSeq(INT64_MAX) - SafeSeq(INT64_MIN) - 1, 0);
}

TEST(UnknownGnssFigures, AnAltitudeThatIsNoneIsAnUnknownHeight) {
  for (const double none : {kNaN, kInf, -kInf, -9999.0, 1e7}) {
    gnss_fix_t message = Fix();
    message.altitude_m = none;
    RefusalTally unused;
    const GnssFix fix = TakenFix(message, unused);
    EXPECT_FALSE(fix.has_height) << none;
    EXPECT_EQ(fix.position.height_m, 0.0);
    EXPECT_EQ(unused.CountOf({Reason::kFieldUnused, "altitude_m"}), std::isnan(none) ? 0u : 1u);
  }
  RefusalTally unused;
  EXPECT_TRUE(TakenFix(Fix(), unused).has_height);
}

TEST(UnknownGnssFigures, AVelocityOrItsSigmaCostsItselfAlone) {
  const auto fix_with = [](const std::function<void(gnss_fix_t&)>& change) {
    gnss_fix_t message = Fix();
    change(message);
    RefusalTally unused;
    return TakenFix(message, unused);
  };
  for (const double none : {kNaN, kInf, 1e4}) {
    EXPECT_FALSE(fix_with([&](auto& m) { m.velocity_east_mps = none; }).velocity_en_mps);
    EXPECT_FALSE(fix_with([&](auto& m) { m.velocity_north_mps = none; }).velocity_en_mps);
    EXPECT_TRUE(fix_with([&](auto& m) { m.velocity_up_mps = none; }).velocity_en_mps);
  }
  for (const double none : {kNaN, 0.0, -1.0, kInf}) {
    const GnssFix fix = fix_with([&](auto& m) { m.velocity_sigma_mps = none; });
    ASSERT_TRUE(fix.velocity_en_mps);
    EXPECT_TRUE(std::isnan(fix.velocity_sigma_mps));
  }
}

TEST(UnknownGnssFigures, AHeadingMayBeCountedEitherWayRound) {
  const auto yaw_of = [](double heading, double sigma = 0.01) {
    gnss_fix_t message = Fix();
    message.heading_rad = heading;
    message.heading_sigma_rad = sigma;
    RefusalTally unused;
    return TakenFix(message, unused).yaw_rad;
  };
  EXPECT_NEAR(*yaw_of(-kPi / 2.0), *yaw_of(1.5 * kPi), 1e-12);
  EXPECT_NEAR(*yaw_of(static_cast<float>(2.0 * kPi)), kPi / 2.0, 1e-6);
  EXPECT_NEAR(*yaw_of(kPi / 2.0, 0.0), 0.0, 1e-12);  // Sigma unknown, heading known.
  EXPECT_NEAR(*yaw_of(kPi / 2.0, kNaN), 0.0, 1e-12);
  EXPECT_FALSE(yaw_of(kNaN));
  EXPECT_FALSE(yaw_of(kInf));
  EXPECT_FALSE(yaw_of(90.0));      // Degrees.
  EXPECT_FALSE(yaw_of(0.0, 0.0));  // Never filled in.
  EXPECT_TRUE(yaw_of(0.0, 0.01));  // Due north.
  gnss_fix_t message = Fix();
  message.heading_rad = 90.0;
  RefusalTally unused;
  TakenFix(message, unused);
  EXPECT_EQ(unused.CountOf({Reason::kFieldUnused, "heading_rad looks like degrees"}), 1u);
}

TEST(UnknownGnssFigures, ACovarianceIsUsedAsFarAsItIsOne) {
  const auto covariance_with = [](const std::function<void(double*)>& change) {
    gnss_fix_t message = Fix();
    change(message.covariance_enu_m2);
    RefusalTally unused;
    return TakenFix(message, unused).covariance_enu;
  };
  EXPECT_EQ(covariance_with([](double*) {})(0, 1), 1.0);
  for (const double none : {kNaN, 0.0, -1.0}) {
    // Up alone.
    const Eigen::Matrix3d up = covariance_with([&](double* c) { c[8] = none; });
    EXPECT_EQ(up(2, 2), 0.0);
    EXPECT_EQ(up(0, 0), 4.0);
    EXPECT_EQ(up(0, 1), 1.0);
    // One axis: the other one's for both, without correlation.
    const Eigen::Matrix3d east = covariance_with([&](double* c) {
      c[0] = none;
      c[1] = c[3] = kNaN;
    });
    EXPECT_EQ(east(0, 0), 9.0);
    EXPECT_EQ(east(1, 1), 9.0);
    EXPECT_EQ(east(0, 1), 0.0);
    // Nothing: unknown, which the alignment has a default for.
    const Eigen::Matrix3d all = covariance_with([&](double* c) {
      for (int i = 0; i < 9; ++i) c[i] = none;
    });
    EXPECT_TRUE(all.isZero(0.0));
  }
  EXPECT_EQ(covariance_with([](double* c) { c[1] = 2.0; })(0, 1), 0.0);         // Not symmetric.
  EXPECT_EQ(covariance_with([](double* c) { c[1] = c[3] = 7.0; })(0, 1), 0.0);  // Above 1.
  EXPECT_EQ(covariance_with([](double* c) { c[1] = c[3] = kInf; })(0, 1), 0.0);
}

TEST(UnknownGnssFigures, AnInfiniteVarianceSaysThatThePlaceIsWorthNothing) {
  gnss_fix_t message = Fix();
  message.covariance_enu_m2[0] = kInf;
  RefusalTally unused;
  const auto fix = FromWire(message, VehicleConfig{}, kReceived, unused);
  ASSERT_FALSE(fix);
  EXPECT_EQ(fix.refusal(), Refusal(Reason::kGnssUnusable, "covariance_enu_m2"));
}

TEST(UnknownGnssFigures, AFixTypeThatIsNoneIsTheLeast) {
  for (const int type : {1, 7, -1, 127}) {
    gnss_fix_t message = Fix();
    message.fix_type = static_cast<std::int8_t>(type);
    RefusalTally unused;
    EXPECT_EQ(TakenFix(message, unused).fix_type, FixType::k2d);
    EXPECT_EQ(unused.CountOf({Reason::kFieldUnused, "fix_type"}), 1u);
  }
  gnss_fix_t message = Fix();
  message.fix_type = 0;
  RefusalTally unused;
  EXPECT_EQ(FromWire(message, VehicleConfig{}, kReceived, unused).refusal(),
            Refusal(Reason::kGnssUnusable, "fix_type"));
}

TEST(UnknownGnssFigures, APlaceThatCannotBeIsRefusedByName) {
  const auto field_of = [](double latitude, double longitude) {
    gnss_fix_t message = Fix();
    message.latitude_rad = latitude;
    message.longitude_rad = longitude;
    RefusalTally unused;
    const auto fix = FromWire(message, VehicleConfig{}, kReceived, unused);
    return fix ? std::string() : std::string(fix.refusal().field);
  };
  EXPECT_EQ(field_of(50.938, 6.957), "latitude_rad looks like degrees");
  EXPECT_EQ(field_of(-33.8, 151.2), "latitude_rad looks like degrees");
  EXPECT_EQ(field_of(1.3, 103.8), "longitude_rad looks like degrees");
  EXPECT_EQ(field_of(kNaN, 0.1), "latitude_rad");
  EXPECT_EQ(field_of(0.8, kInf), "longitude_rad");
  EXPECT_EQ(field_of(100.0, 0.1), "latitude_rad");
  EXPECT_EQ(field_of(0.0, 0.0), "latitude_rad and longitude_rad are 0");
  EXPECT_EQ(field_of(-0.0, 1e-300), "latitude_rad and longitude_rad are 0");
  EXPECT_EQ(field_of(0.0, 0.1), "");  // The equator, and the meridian of Greenwich.
  EXPECT_EQ(field_of(0.9, 0.0), "");
  EXPECT_EQ(field_of(0.8, 1.9 * kPi), "");  // Counted from 0 to 2 pi.
  gnss_fix_t message = Fix();
  message.longitude_rad = 1.5 * kPi;
  RefusalTally unused;
  EXPECT_NEAR(TakenFix(message, unused).position.longitude_rad, -0.5 * kPi, 1e-12);
}

TEST(UnknownRadarFigures, StrengthAndIdCostThemselvesAlone) {
  for (const double none : {kNaN, kInf, -kInf, 1e6}) {
    radar_scan_t message = Scan();
    message.detections[0].rcs_dbsm = message.detections[0].snr_db = none;
    message.detections[0].track_id = -77;
    RefusalTally unused;
    const auto scan = FromWire(message, RadarConfig{}, 0, kReceived, unused);
    ASSERT_TRUE(scan);
    ASSERT_EQ(scan->detections.size(), 1u) << none;
    EXPECT_TRUE(std::isnan(scan->detections[0].rcs_dbsm) && std::isnan(scan->detections[0].snr_db));
    EXPECT_EQ(scan->detections[0].track_id, -1);
    EXPECT_EQ(unused.CountOf({Reason::kFieldUnused, "detections.rcs_dbsm"}),
              std::isnan(none) ? 0u : 1u);
  }
}

TEST(UnknownRadarFigures, AnAzimuthMayBeCountedEitherWayRound) {
  radar_scan_t message = Scan();
  message.detections[0].azimuth_rad = 2.0 * kPi - 0.2;
  message.detections.push_back({20.0, 30.0, -5.0, 10.0, 15.0, 7});
  message.sensor.clear();  // The channel says it.
  RefusalTally unused;
  const auto scan = FromWire(message, RadarConfig{}, 0, kReceived, unused);
  ASSERT_TRUE(scan);
  ASSERT_EQ(scan->detections.size(), 1u);
  EXPECT_NEAR(scan->detections[0].azimuth_rad, -0.2, 1e-12);
  EXPECT_EQ(unused.CountOf({Reason::kOutOfRange, "detections.azimuth_rad looks like degrees"}), 1u);
}

TEST(UnknownCameraFigures, AScoreThatIsNoneIsASureBox) {
  const auto score_of = [](double score) {
    camera_detections_t message = Boxes();
    message.boxes[0].score = score;
    RefusalTally unused;
    const auto boxes = FromWire(message, CameraConfig{}, 0, kReceived, unused);
    return boxes && boxes->boxes.size() == 1 ? boxes->boxes[0].score : -1.0;
  };
  EXPECT_EQ(score_of(kNaN), 1.0);
  EXPECT_EQ(score_of(0.0), 1.0);
  EXPECT_EQ(score_of(kInf), 1.0);
  EXPECT_EQ(score_of(-1.0), 1.0);
  EXPECT_EQ(score_of(1.0000001), 1.0);
  EXPECT_EQ(score_of(0.25), 0.25);
  EXPECT_EQ(score_of(87.0), 0.87);  // Percent.
}

TEST(UnknownCameraFigures, AnUnknownPictureSizeIsTheConfiguredOne) {
  camera_detections_t message = Boxes();
  message.image_width_px = message.image_height_px = 0;
  message.boxes[0].class_name = "CAR";
  message.boxes[0].class_id = -99;
  RefusalTally unused;
  const auto boxes = FromWire(message, CameraConfig{}, 0, kReceived, unused);
  ASSERT_TRUE(boxes);
  EXPECT_EQ(boxes->image_width_px, CameraConfig{}.image_width_px);
  EXPECT_EQ(boxes->boxes[0].object_class, ObjectClass::kCar);
  message = Boxes();
  message.image_height_px = 360;
  EXPECT_EQ(FromWire(message, CameraConfig{}, 0, kReceived, unused).refusal(),
            Refusal(Reason::kOutOfRange, "image_height_px"));
}

// One step past each end of each range of SAE J2735 Part I (notes in lcmtypes/bsm_t.lcm), and far
// past it.
TEST(UnknownBsmFigures, AFieldThatJ2735DoesNotDefineIsUnavailableByItself) {
  const auto unused_by = [](const std::function<void(bsm_t&)>& change) {
    bsm_t raw = RawBsm();
    change(raw);
    RefusalTally unused;
    const auto bsm = FromWire(raw, kReceived, unused);
    if (!bsm) return std::string("refused");
    EXPECT_NEAR(*bsm->latitude_rad, FromDegrees(50.938), 1e-12);
    EXPECT_NEAR(*bsm->speed_mps, 10.0, 1e-12);
    return unused.entries().empty() ? std::string()
                                    : std::string(unused.entries()[0].refusal.field);
  };
#define V2VOUCH_UNUSED(name, value) \
  EXPECT_EQ(unused_by([](bsm_t& m) { m.name = value; }), #name) << #name " = " #value
  V2VOUCH_UNUSED(msgCnt, -1);
  V2VOUCH_UNUSED(msgCnt, 128);
  V2VOUCH_UNUSED(secMark, -1);
  V2VOUCH_UNUSED(secMark, 61000);
  V2VOUCH_UNUSED(secMark, 65534);
  V2VOUCH_UNUSED(secMark, 65536);
  V2VOUCH_UNUSED(elev, -4097);
  V2VOUCH_UNUSED(elev, 61440);
  V2VOUCH_UNUSED(semiMajor, 256);
  V2VOUCH_UNUSED(semiMinor, -1);
  V2VOUCH_UNUSED(orientation, 65536);
  V2VOUCH_UNUSED(transmission, 8);
  V2VOUCH_UNUSED(transmission, -1);
  V2VOUCH_UNUSED(heading, 28801);
  V2VOUCH_UNUSED(heading, -1);
  V2VOUCH_UNUSED(accelSet_long, 2002);
  V2VOUCH_UNUSED(accelSet_lat, -2001);
  V2VOUCH_UNUSED(accelSet_yaw, 32768);
  V2VOUCH_UNUSED(accelSet_yaw, -32768);
  V2VOUCH_UNUSED(width, 1024);
  V2VOUCH_UNUSED(length, 4096);
  V2VOUCH_UNUSED(generation_utime, kUtime / 1000);  // Milliseconds.
  V2VOUCH_UNUSED(signature_state, 5);
  V2VOUCH_UNUSED(rssi_dbm, std::numeric_limits<float>::infinity());
#undef V2VOUCH_UNUSED
  // Not read at all.
  EXPECT_EQ(unused_by([](bsm_t& m) {
              m.angle = -127;
              m.accelSet_vert = -128;
              m.wheelBrakes = 32;
              m.traction = m.abs = m.scs = m.brakeBoost = m.auxBrakes = 99;
            }),
            "");
}

TEST(UnknownBsmFigures, WithoutPlaceOrSpeedThereIsNoClaim) {
  const auto refusal_of = [](const std::function<void(bsm_t&)>& change) {
    bsm_t raw = RawBsm();
    change(raw);
    RefusalTally unused;
    const auto bsm = FromWire(raw, kReceived, unused);
    return bsm ? Refusal() : bsm.refusal();
  };
  const Refusal lat(Reason::kBsmRange, "lat");
  const Refusal longitude(Reason::kBsmRange, "long_");
  const Refusal speed(Reason::kBsmRange, "speed");
  EXPECT_EQ(refusal_of([](bsm_t& m) { m.lat = 900000002; }), lat);
  EXPECT_EQ(refusal_of([](bsm_t& m) { m.lat = -900000001; }), lat);
  EXPECT_EQ(refusal_of([](bsm_t& m) { m.long_ = 1800000002; }), longitude);
  EXPECT_EQ(refusal_of([](bsm_t& m) { m.long_ = -1800000000; }), longitude);
  EXPECT_EQ(refusal_of([](bsm_t& m) { m.speed = 8192; }), speed);
  EXPECT_EQ(refusal_of([](bsm_t& m) { m.speed = -1; }), speed);
  EXPECT_EQ(refusal_of([](bsm_t& m) { m.lat = m.long_ = 0; }),
            Refusal(Reason::kBsmUnavailable, "lat and long_ are 0"));
  EXPECT_EQ(refusal_of([](bsm_t& m) { m.rx_utime /= 1000; }),
            Refusal(Reason::kOutOfRange, "rx_utime looks like milliseconds"));
  EXPECT_EQ(refusal_of([](bsm_t& m) { m.rx_utime = 0; }), Refusal(Reason::kOutOfRange, "rx_utime"));
}

TEST(TimeFault, AnotherUnitIsToldByWhatItWouldMean) {
  EXPECT_EQ(TimeFault(kUtime, kReceived), "");
  EXPECT_EQ(TimeFault(kUtime / 1000, kReceived), "utime looks like milliseconds");
  EXPECT_EQ(TimeFault(kUtime / 1'000'000, kReceived), "utime looks like seconds");
  EXPECT_EQ(TimeFault(kUtime * 1000, kReceived), "utime looks like nanoseconds");
  EXPECT_EQ(TimeFault(0, kReceived), "utime");
  EXPECT_EQ(TimeFault(-5, kReceived), "utime");
  EXPECT_EQ(TimeFault(INT64_MAX, kReceived), "utime");
  EXPECT_EQ(TimeFault(INT64_MIN, kReceived), "utime");
  // A log of last year, played today, in milliseconds.
  EXPECT_EQ(TimeFault(kUtime / 1000, kReceived + FromSeconds(365 * 86400.0)),
            "utime looks like milliseconds");
}

// A clock that was never set lives in 1970: half an hour, a day, three weeks after it was switched
// on.
TEST(TimeFault, AClockThatWasNeverSetIsNoOtherUnit) {
  for (const double up_s : {1.0, 1000.0, 86400.0, 3600.0 * 24 * 5}) {
    const Timestamp stamp = FromMicros(0) + FromSeconds(up_s);
    EXPECT_EQ(TimeFault(ToMicros(stamp), stamp), "") << up_s;
    EXPECT_EQ(TimeFault(ToMicros(stamp), kReceived), "") << up_s;
  }
  const Timestamp weeks = FromMicros(0) + FromSeconds(86400.0 * 21);
  EXPECT_EQ(TimeFault(ToMicros(weeks), weeks), "");  // This computer's clock was not set either.
}

TEST(TimeFault, EveryOwnTypeNamesIt) {
  RefusalTally unused;
  const Refusal expected(Reason::kOutOfRange, "utime looks like milliseconds");
  ego_motion_t ego = Ego();
  ego.utime /= 1000;
  EXPECT_EQ(FromWire(ego, VehicleConfig{}, kReceived, unused).refusal(), expected);
  gnss_fix_t fix = Fix();
  fix.utime /= 1000;
  EXPECT_EQ(FromWire(fix, VehicleConfig{}, kReceived, unused).refusal(), expected);
  radar_scan_t scan = Scan();
  scan.utime /= 1000;
  EXPECT_EQ(FromWire(scan, RadarConfig{}, 0, kReceived, unused).refusal(), expected);
  camera_detections_t boxes = Boxes();
  boxes.utime /= 1000;
  EXPECT_EQ(FromWire(boxes, CameraConfig{}, 0, kReceived, unused).refusal(), expected);
}

}  // namespace
}  // namespace v2vouch::wire
