// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "daemon/rim/wire/bsm_conversion.h"
#include "daemon/rim/wire/codec.h"
#include "daemon/rim/wire/input_decoder.h"
#include "daemon/rim/wire/output_encoder.h"
#include "daemon/rim/wire/sensor_conversion.h"
#include "daemon/rim/wire/status_encoder.h"
#include "tests/support/data_folder.h"
#include "v2vouch/bsm_verdict_t.hpp"
#include "v2vouch/calibration_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/text_t.hpp"

namespace v2vouch::wire {
namespace {

constexpr std::int64_t kUtime = 1'700'000'000'000'000;

std::uint64_t CountOf(const RefusalTally& counts, Reason reason) { return counts.CountOf(reason); }

using wire::FromWire;

// Where the test does not look at what was left unused.
Result<EgoMotion> FromWire(const ego_motion_t& message, const VehicleConfig& vehicle,
                           Timestamp received) {
  RefusalTally unused;
  return wire::FromWire(message, vehicle, received, unused);
}
Result<GnssFix> FromWire(const gnss_fix_t& message, const VehicleConfig& vehicle,
                         Timestamp received) {
  RefusalTally unused;
  return wire::FromWire(message, vehicle, received, unused);
}
Result<Bsm> FromWire(const bsm_t& message, Timestamp received) {
  RefusalTally unused;
  return wire::FromWire(message, received, unused);
}

radar_scan_t Scan() {
  radar_scan_t scan{};
  scan.utime = kUtime;
  scan.seq = 3;
  scan.sensor = "FRONT";
  scan.detections = {{20.0, 0.2, -5.0, kNaN, 15.0, -1}};
  scan.num_detections = 1;
  return scan;
}

TEST(RadarFromWire, SignsAndOffsetsOfTheSensorAreApplied) {
  RadarConfig radar;
  radar.flip_azimuth = true;
  radar.flip_range_rate = true;
  radar.range_offset_m = 1.5;
  radar.clock_offset_s = -0.02;
  RefusalTally dropped;
  const auto scan = FromWire(Scan(), radar, 2, FromMicros(7), dropped);
  ASSERT_TRUE(scan);
  EXPECT_EQ(ToMicros(scan->stamp), kUtime - 20'000);
  EXPECT_EQ(ToMicros(scan->received), 7);
  EXPECT_EQ(scan->radar, 2);
  ASSERT_EQ(scan->detections.size(), 1u);
  EXPECT_DOUBLE_EQ(scan->detections[0].range_m, 21.5);
  EXPECT_DOUBLE_EQ(scan->detections[0].azimuth_rad, -0.2);
  EXPECT_DOUBLE_EQ(scan->detections[0].range_rate_mps, 5.0);
  EXPECT_TRUE(std::isnan(scan->detections[0].rcs_dbsm));
}

TEST(RadarFromWire, OneBadDetectionIsLeftOutAndCounted) {
  radar_scan_t message = Scan();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {kNaN, inf, -1.0, 1e6}) {
    message.detections.push_back({bad, 0.0, 0.0, 0.0, 0.0, -1});
  }
  message.detections.push_back({10.0, 6.4, 0.0, 0.0, 0.0, -1});
  message.detections.push_back({10.0, 0.0, kNaN, 0.0, 0.0, -1});
  message.detections.push_back({10.0, 7.0, 0.0, 0.0, 0.0, -1});
  RefusalTally dropped;
  const auto scan = FromWire(message, RadarConfig{}, 0, {}, dropped);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->detections.size(), 1u);
  EXPECT_EQ(CountOf(dropped, Reason::kNotFinite), 3u);
  EXPECT_EQ(CountOf(dropped, Reason::kOutOfRange), 4u);
}

// A corner radar's range offset may take what is on its radome behind the antenna.
TEST(RadarFromWire, RangesThatAreNoneCostThemselvesAlone) {
  RadarConfig radar;
  radar.name = "FRONT";
  radar.range_offset_m = -0.5;
  radar_scan_t message = Scan();
  for (const double range_m : {0.5, 0.3, 0.0, -0.2, 1e-12, 0.51}) {
    message.detections.push_back({range_m, 1.2, 0.0, 0.0, 0.0, -1});
  }
  message.num_detections = static_cast<std::int32_t>(message.detections.size());
  RefusalTally dropped;
  const auto scan = FromWire(message, radar, 0, {}, dropped);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->detections.size(), 2u);
  EXPECT_EQ(dropped.CountOf({Reason::kOutOfRange, "detections.range_m"}), 5u);
}

TEST(RadarFromWire, WrongSensorAndImpossibleStampsAreRefused) {
  RefusalTally dropped;
  radar_scan_t message = Scan();
  message.sensor = "REAR";
  EXPECT_EQ(FromWire(message, RadarConfig{}, 0, {}, dropped).reason(), Reason::kSensorMismatch);
  for (const std::int64_t utime :
       {std::int64_t{0}, std::int64_t{-5}, std::int64_t{INT64_MAX}, std::int64_t{INT64_MIN}}) {
    message = Scan();
    message.utime = utime;
    EXPECT_EQ(FromWire(message, RadarConfig{}, 0, {}, dropped).reason(), Reason::kOutOfRange);
  }
}

TEST(CameraFromWire, BoxesAreJudgedOneByOneAndTheResolutionMustFit) {
  camera_detections_t message{};
  message.utime = kUtime;
  message.sensor = "FRONT";
  message.image_width_px = 1280;
  message.image_height_px = 720;
  message.boxes = {{1.0, 2.0, 30.0, 40.0, 2, "truck", 0.9},
                   {1.0, 2.0, 0.0, 40.0, 2, "car", 0.9},
                   {kNaN, 2.0, 3.0, 40.0, 2, "car", 0.9},
                   {1.0, 2.0, 3.0, 40.0, 2, "spaceship", 0.5}};
  message.num_boxes = 4;
  RefusalTally dropped;
  const auto boxes = FromWire(message, CameraConfig{}, 0, {}, dropped);
  ASSERT_TRUE(boxes);
  ASSERT_EQ(boxes->boxes.size(), 2u);
  EXPECT_EQ(boxes->boxes[0].object_class, ObjectClass::kTruck);
  EXPECT_EQ(boxes->boxes[1].object_class, ObjectClass::kUnknown);
  EXPECT_EQ(CountOf(dropped, Reason::kOutOfRange) + CountOf(dropped, Reason::kNotFinite), 2u);
  message.image_width_px = 640;
  EXPECT_EQ(FromWire(message, CameraConfig{}, 0, {}, dropped).reason(), Reason::kOutOfRange);
}

ego_motion_t Ego() {
  ego_motion_t ego{};
  ego.utime = kUtime;
  ego.speed_mps = 10.0;
  ego.speed_sigma_mps = 0.1;
  ego.yaw_rate_sigma_radps = 0.01;
  ego.accel_long_mps2 = kNaN;
  ego.accel_lat_mps2 = 0.5;
  ego.gear = 2;
  return ego;
}

TEST(EgoFromWire, UnavailableIsEmptyAndNonsenseIsRefused) {
  const auto ego = FromWire(Ego(), VehicleConfig{}, {});
  ASSERT_TRUE(ego);
  EXPECT_FALSE(ego->accel_long_mps2);
  EXPECT_EQ(ego->accel_lat_mps2, 0.5);
  EXPECT_EQ(ego->gear, Gear::kForward);
  ego_motion_t bad = Ego();
  bad.speed_mps = kNaN;
  EXPECT_EQ(FromWire(bad, VehicleConfig{}, {}).reason(), Reason::kNotFinite);
  EXPECT_EQ(FromWire(bad, VehicleConfig{}, {}).refusal().field, "speed_mps");
  bad = Ego();
  bad.speed_mps = 130.0;
  EXPECT_EQ(FromWire(bad, VehicleConfig{}, {}).reason(), Reason::kOutOfRange);
}

// Of an odometer that shows 4 % too much, and of one that shows 4 % too little.
TEST(EgoFromWire, OdometerScaleAndGyroBiasAreTakenOff) {
  for (const double sign : {1.0, -1.0}) {
    VehicleConfig vehicle;
    vehicle.speed_scale = 1.0 + sign * 0.04;
    vehicle.yaw_rate_bias_radps = sign * 0.003;
    ego_motion_t message = Ego();
    message.speed_mps = -10.0 * vehicle.speed_scale;  // In reverse too.
    message.yaw_rate_radps = 0.2 + sign * 0.003;
    const auto ego = FromWire(message, vehicle, {});
    ASSERT_TRUE(ego);
    EXPECT_NEAR(ego->speed_mps, -10.0, 1e-12);
    EXPECT_NEAR(ego->speed_sigma_mps, 0.1 / vehicle.speed_scale, 1e-12);
    EXPECT_NEAR(ego->yaw_rate_radps, 0.2, 1e-12);
    EXPECT_EQ(ego->yaw_rate_sigma_radps, message.yaw_rate_sigma_radps);
  }
}

gnss_fix_t Fix() {
  gnss_fix_t fix{};
  fix.utime = kUtime;
  fix.latitude_rad = 0.8;
  fix.longitude_rad = -0.1;
  fix.altitude_m = kNaN;
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

TEST(GnssFromWire, HeadingClockwiseFromNorthBecomesYawFromEast) {
  gnss_fix_t message = Fix();
  EXPECT_NEAR(*FromWire(message, VehicleConfig{}, {})->yaw_rad, 0.0, 1e-12);
  message.heading_rad = 0.0;  // North.
  EXPECT_NEAR(*FromWire(message, VehicleConfig{}, {})->yaw_rad, kPi / 2.0, 1e-12);
  message.heading_rad = 1.5 * kPi;  // West.
  EXPECT_NEAR(std::abs(*FromWire(message, VehicleConfig{}, {})->yaw_rad), kPi, 1e-12);
  message.heading_rad = kNaN;
  EXPECT_FALSE(FromWire(message, VehicleConfig{}, {})->yaw_rad);
  EXPECT_EQ(FromWire(message, VehicleConfig{}, {})->position.height_m, 0.0);
  EXPECT_EQ(FromWire(message, VehicleConfig{}, {})->covariance_enu(0, 1), 1.0);
}

// A receiver whose heading reads 3 degrees too far to the left of a car that drives due east says
// 87 degrees from north; one that reads too far to the right says 93.
TEST(GnssFromWire, HeadingBiasIsTakenOff) {
  for (const double bias_deg : {3.0, -3.0}) {
    VehicleConfig vehicle;
    vehicle.heading_bias_rad = FromDegrees(bias_deg);
    gnss_fix_t message = Fix();
    message.heading_rad = FromDegrees(90.0 - bias_deg);
    EXPECT_NEAR(*FromWire(message, vehicle, {})->yaw_rad, 0.0, 1e-12);
    message.heading_rad = FromDegrees(270.0 - bias_deg);
    EXPECT_NEAR(std::abs(*FromWire(message, vehicle, {})->yaw_rad), kPi, 1e-12);
    EXPECT_EQ(*FromWire(message, vehicle, {})->velocity_en_mps, Eigen::Vector2d(3.0, 4.0));
  }
}

bsm_t RawBsm() {
  bsm_t bsm{};
  bsm.rx_utime = kUtime;
  bsm.id[0] = 0xBE;
  bsm.id[3] = 0x01;
  bsm.secMark = 65535;
  bsm.lat = 900000001;
  bsm.long_ = 1800000001;
  bsm.elev = -4096;
  bsm.semiMajor = bsm.semiMinor = 255;
  bsm.orientation = 65535;
  bsm.transmission = 7;
  bsm.speed = 8191;
  bsm.heading = 28800;
  bsm.angle = 127;
  bsm.accelSet_long = bsm.accelSet_lat = 2001;
  bsm.accelSet_vert = -127;
  bsm.rssi_dbm = std::numeric_limits<float>::quiet_NaN();
  return bsm;
}

TEST(BsmFromWire, EverySentinelIsEmpty) {
  const auto bsm = FromWire(RawBsm(), {});
  ASSERT_TRUE(bsm);
  EXPECT_EQ(bsm->sender, 0xBE000001u);
  EXPECT_FALSE(bsm->generation || bsm->sec_mark_ms || bsm->latitude_rad || bsm->longitude_rad);
  EXPECT_FALSE(bsm->elevation_m || bsm->semi_major_m || bsm->semi_minor_m ||
               bsm->semi_major_yaw_rad);
  EXPECT_FALSE(bsm->speed_mps || bsm->course_rad || bsm->accel_long_mps2 || bsm->accel_lat_mps2);
  EXPECT_FALSE(bsm->yaw_rate_radps || bsm->length_m || bsm->width_m);
  EXPECT_EQ(bsm->transmission, Transmission::kUnavailable);
}

TEST(BsmFromWire, UnitsAndDirectionsAreTurned) {
  bsm_t raw = RawBsm();
  raw.lat = -338688197;  // Sydney.
  raw.long_ = 1512092955;
  raw.elev = 1234;
  raw.speed = 500;
  raw.heading = 7200;  // 90 degrees: east.
  raw.accelSet_long = -150;
  raw.accelSet_yaw = 1000;  // 10 degrees/s to the right.
  raw.length = 450;
  raw.width = 180;
  raw.semiMajor = 40;
  raw.secMark = 60999;
  raw.transmission = 3;
  const auto bsm = FromWire(raw, {});
  ASSERT_TRUE(bsm);
  EXPECT_NEAR(*bsm->latitude_rad, FromDegrees(-33.8688197), 1e-15);
  EXPECT_NEAR(*bsm->longitude_rad, FromDegrees(151.2092955), 1e-14);
  EXPECT_NEAR(*bsm->elevation_m, 123.4, 1e-9);
  EXPECT_NEAR(*bsm->speed_mps, 10.0, 1e-12);
  EXPECT_NEAR(*bsm->course_rad, 0.0, 1e-12);
  EXPECT_NEAR(*bsm->accel_long_mps2, -1.5, 1e-12);
  EXPECT_NEAR(*bsm->yaw_rate_radps, FromDegrees(-10.0), 1e-12);
  EXPECT_NEAR(*bsm->length_m, 4.5, 1e-12);
  EXPECT_NEAR(*bsm->width_m, 1.8, 1e-12);
  EXPECT_NEAR(*bsm->semi_major_m, 2.0, 1e-12);
  EXPECT_EQ(bsm->sec_mark_ms, 60999);
  EXPECT_EQ(bsm->transmission, Transmission::kReverse);
}

// BSMs of real on-board units with their published decoded values.
TEST(BsmFromWire, PublishedMessagesHaveTheirPublishedValues) {
  std::ifstream file(DataFolder() / "j2735_bsm_vectors.json");
  if (!file) GTEST_SKIP() << "SKIPPED: no j2735_bsm_vectors.json under V2VOUCH_DATA";
  const auto json = nlohmann::json::parse(file);
  const std::map<std::string, int> gears = {
      {"neutral", 0}, {"park", 1}, {"forwardGears", 2}, {"reverseGears", 3}, {"unavailable", 7}};
  int checked = 0;
  for (const auto& vector : json["vectors"]) {
    const auto& core = vector["core"];
    bsm_t raw = RawBsm();
    raw.msgCnt = core["msgCnt"];
    const auto id =
        static_cast<std::uint32_t>(std::stoul(core["id"].get<std::string>(), nullptr, 16));
    for (int i = 0; i < 4; ++i) raw.id[i] = static_cast<std::uint8_t>(id >> (24 - 8 * i));
    raw.secMark = core["secMark"];
    raw.lat = core["lat"];
    raw.long_ = core["long"];
    raw.elev = core["elev"];
    raw.semiMajor = core["semiMajor"];
    raw.semiMinor = core["semiMinor"];
    raw.orientation = core["orientation"];
    const auto gear = gears.find(core["transmission"].get<std::string>());
    raw.transmission = static_cast<std::int8_t>(gear == gears.end() ? 4 : gear->second);
    raw.speed = core["speed"];
    raw.heading = core["heading"];
    raw.angle = core["angle"];
    raw.accelSet_long = core["accelLong"];
    raw.accelSet_lat = core["accelLat"];
    raw.accelSet_vert = core["accelVert"];
    raw.accelSet_yaw = core["accelYaw"];
    raw.width = core["width"];
    raw.length = core["length"];
    const auto bsm = FromWire(raw, {});
    if (raw.lat == 0 && raw.long_ == 0) {  // A unit without a place yet.
      EXPECT_EQ(bsm.refusal(), Refusal(Reason::kBsmUnavailable, "lat and long_ are 0"));
      continue;
    }
    ASSERT_TRUE(bsm) << vector["n"] << " " << ReasonName(bsm.reason()) << core;
    ++checked;
    const auto& si = vector["si"];
    const auto agrees = [&](const char* key, std::optional<double> ours, double scale = 1.0) {
      if (si[key].is_null()) {
        EXPECT_FALSE(ours) << key << vector["n"];
      } else if (ours) {
        EXPECT_NEAR(*ours, si[key].get<double>() * scale, 1e-6) << key << vector["n"];
      } else {
        EXPECT_STREQ(key, "yaw_rate_dps");  // 0 may also mean unavailable.
        EXPECT_EQ(si[key].get<double>(), 0.0);
      }
    };
    EXPECT_EQ(bsm->sender, id);
    agrees("lat_deg", bsm->latitude_rad, kPi / 180.0);
    agrees("lon_deg", bsm->longitude_rad, kPi / 180.0);
    agrees("elev_m", bsm->elevation_m);
    agrees("speed_mps", bsm->speed_mps);
    agrees("semi_major_m", bsm->semi_major_m);
    agrees("semi_minor_m", bsm->semi_minor_m);
    agrees("accel_long_mps2", bsm->accel_long_mps2);
    agrees("yaw_rate_dps", bsm->yaw_rate_radps, -kPi / 180.0);
    agrees("width_m", bsm->width_m);
    agrees("length_m", bsm->length_m);
    if (si["heading_deg"].is_null()) {
      EXPECT_FALSE(bsm->course_rad);
    } else {
      EXPECT_NEAR(
          AngleDifference(*bsm->course_rad, FromDegrees(90.0 - si["heading_deg"].get<double>())),
          0.0, 1e-9);
    }
  }
  EXPECT_EQ(checked, 166);  // Of 167, one tells 0, 0: a unit without a place yet.
}

TEST(ListToWire, BodyFrameIsTheOdometryFrameSeenFromTheEgo) {
  TrackList list;
  list.stamp = FromMicros(kUtime);
  list.X_OB = Pose<Odometry, Body>(100.0, 50.0, kPi / 2.0);  // Looking along O's y.
  PublishedTrack line;
  line.track.id = 0xF000000000000001ull;
  line.track.state_O.mean << 100.0, 60.0, kPi, 5.0, 0.1, -1.0;
  line.track.state_O.covariance = StateMatrix::Identity();
  line.track.state_O.covariance(kX, kX) = 4.0;
  line.track.state_O.covariance(kX, kSpeed) = line.track.state_O.covariance(kSpeed, kX) = 0.5;
  line.sender = 0x01020304;
  list.tracks = {line};
  const track_list_t wire = ToWire(list, VehicleConfig());
  ASSERT_EQ(wire.num_tracks, 1);
  const track_t& track = wire.tracks[0];
  EXPECT_EQ(static_cast<std::uint64_t>(track.id), 0xF000000000000001ull);
  EXPECT_NEAR(track.x_body_m, 10.0, 1e-12);
  EXPECT_NEAR(track.y_body_m, 0.0, 1e-12);
  EXPECT_NEAR(track.yaw_body_rad, kPi / 2.0, 1e-12);
  EXPECT_NEAR(track.covariance_body[0], 1.0, 1e-12);           // O's y variance, now along body x.
  EXPECT_NEAR(track.covariance_body[7], 4.0, 1e-12);           // O's x variance, now along body y.
  EXPECT_NEAR(track.covariance_body[1 * 6 + 3], -0.5, 1e-12);  // O's x points to body -y.
  EXPECT_NEAR(track.covariance_body[3 * 6 + 1], -0.5, 1e-12);
  EXPECT_EQ(track.covariance_odom[0], 4.0);
  EXPECT_EQ(track.v2v_id[0], 1);
  EXPECT_EQ(track.v2v_id[3], 4);
  EXPECT_TRUE(std::isnan(track.latitude_rad));
  EXPECT_EQ(track.num_sources, 0);
  EXPECT_EQ(track.events, 0);
}

TEST(ListToWire, NamesEverySourceWithItsLastMeasurement) {
  VehicleConfig vehicle;  // Three radars, one camera.
  vehicle.objects.push_back({.name = "LIDAR"});
  PublishedTrack line;
  SensorSupport& support = line.track.support;
  support.Add({SensorKind::kObjects, 0}, FromMicros(kUtime + 3));
  support.Add({SensorKind::kRadar, 2}, FromMicros(kUtime));
  support.Add({SensorKind::kRadar, 2}, FromMicros(kUtime + 1));
  support.Add({SensorKind::kCamera, 0}, FromMicros(kUtime + 2));
  line.last_v2v = FromMicros(kUtime + 4);
  line.events = kBrakeLamps;
  TrackList list;
  list.tracks = {line};
  const track_t track = ToWire(list, vehicle).tracks[0];
  std::string text;
  for (const track_source_t& source : track.sources) {
    text += std::to_string(source.kind) + " " + source.name + " " +
            std::to_string(source.last_utime - kUtime) + "\n";
  }
  EXPECT_EQ(text, "0 FRONT_RIGHT 1\n1 FRONT 2\n2 LIDAR 3\n3  4\n");
  EXPECT_EQ(track.events, track_t::EVENT_BRAKE_LAMPS);
}

// Everything we publish passes our own decoder.
TEST(OutputEncoder, OurOwnDecoderTakesWhatWeWrite) {
  std::vector<std::uint8_t> bytes;
  TrackList list;
  list.tracks.resize(9000);  // More than a list may hold.
  list.sectors.resize(3);
  EncodeList(list, VehicleConfig(), bytes);
  EXPECT_TRUE(Decode<track_list_t>(bytes));
  EncodeText({}, "name", std::string("a\0b", 3) + std::string(3'000'000, 'x'), bytes);
  EXPECT_TRUE(Decode<text_t>(bytes));
  Status status;
  status.refusals.fill(7);
  status.inputs.resize(3);
  status.latencies.resize(2);
  status.version = std::string(1000, 'v');
  EncodeStatus(status, bytes);
  const auto decoded = Decode<daemon_status_t>(bytes);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->refusals.size(), kReasonCount);
  MisbehaviorReport report;
  report.check = Check::kContestedIdentity;
  report.evidence = {{"residual_m", 3.0}};
  EncodeReport(report, bytes);
  EXPECT_EQ(Decode<misbehavior_report_t>(bytes)->check, "contested_identity");
  EXPECT_EQ(Decode<misbehavior_report_t>(bytes)->evidence[0].value, 3.0);
  EXPECT_EQ(Decode<misbehavior_report_t>(bytes)->etsi_class, misbehavior_report_t::ETSI_NONE);
  EXPECT_EQ(Decode<misbehavior_report_t>(bytes)->is_j3287, 0);
  report.check = Check::kImplausibleMotion;
  EncodeReport(report, bytes);
  EXPECT_EQ(Decode<misbehavior_report_t>(bytes)->etsi_class, misbehavior_report_t::ETSI_SPEED);
  EncodeVerdict({FromMicros(5), 6, 0x01020304, TrustState::kNone, Reason::kBsmStale}, bytes);
  EXPECT_EQ(Decode<bsm_verdict_t>(bytes)->refusal, "bsm_stale");
  EncodeVerdict({FromMicros(5), 6, 0x01020304, TrustState::kSuspect, std::nullopt}, bytes);
  const auto verdict = Decode<bsm_verdict_t>(bytes);
  EXPECT_EQ(verdict->refusal, "");
  EXPECT_EQ(verdict->trust_state, track_t::TRUST_SUSPECT);
  EXPECT_EQ(verdict->utime, 5);
  EXPECT_EQ(verdict->seq, 6);
  EXPECT_EQ(verdict->sender_id[0], 1);
  CalibrationInForce calibration;
  calibration.parameters = {{"a", 1.0, 2.0, "PRIOR"}};
  EncodeCalibration(calibration, bytes);
  EXPECT_EQ(Decode<calibration_t>(bytes)->parameters[0].verdict, "PRIOR");
  CameraDetections detections;
  detections.boxes.resize(2);
  CameraConfig camera;
  camera.clock_offset_s = 0.25;
  detections.stamp = FromMicros(kUtime) + std::chrono::milliseconds(250);
  EncodeDetections(detections, camera, bytes);
  EXPECT_EQ(Decode<camera_detections_t>(bytes)->boxes.size(), 2u);
  EXPECT_EQ(Decode<camera_detections_t>(bytes)->utime, kUtime);  // Added again when read back.
}

TEST(InputDecoder, KnowsTheChannelsOfTheVehicle) {
  VehicleConfig vehicle;
  vehicle.cameras.resize(3);
  vehicle.cameras[1].name = "LEFT";
  vehicle.cameras[1].source = CameraSource::kImage;
  vehicle.cameras[2].name = "RIGHT";
  vehicle.cameras[2].source = CameraSource::kDetected;
  const InputDecoder decoder(vehicle, ChannelNames{});
  std::vector<std::string> names;
  for (const InputChannel& channel : decoder.channels()) names.push_back(channel.name);
  const std::vector<std::string> expected = {"EGO_MOTION",
                                             "RADAR_" + vehicle.radars[0].name,
                                             "CAMERA_FRONT",
                                             "CAMERA_LEFT_IMAGE",
                                             "CAMERA_RIGHT_DETECTED",
                                             "EGO_GNSS",
                                             "BSM"};
  EXPECT_THAT(names, testing::IsSupersetOf(expected));
  EXPECT_FALSE(decoder.Find("TRUTH"));
  EXPECT_FALSE(decoder.Find("CAMERA_LEFT"));
  std::vector<std::uint8_t> bytes;
  Encode(Ego(), bytes);
  RefusalTally dropped;
  EXPECT_TRUE(decoder.Decode(*decoder.Find("EGO_MOTION"), bytes, {}, dropped));
  EXPECT_EQ(decoder.Decode(*decoder.Find("BSM"), bytes, {}, dropped).reason(), Reason::kWrongType);
}

TEST(InputDecoder, RawPicturesMustHaveTheBytesTheirSizeTakes) {
  VehicleConfig vehicle;
  vehicle.cameras[0].source = CameraSource::kImage;
  vehicle.cameras[0].image_width_px = 4;
  vehicle.cameras[0].image_height_px = 2;
  const InputDecoder decoder(vehicle, ChannelNames{});
  camera_image_t image{};
  image.utime = kUtime;
  image.sensor = "FRONT";
  image.width_px = 4;
  image.height_px = 2;
  const auto refused = [&](const char* encoding, std::size_t size) {
    image.encoding = encoding;
    image.data.assign(size, 1);
    image.num_bytes = static_cast<std::int32_t>(size);
    std::vector<std::uint8_t> bytes;
    Encode(image, bytes);
    RefusalTally dropped;
    const auto decoded = decoder.Decode(*decoder.Find("CAMERA_FRONT_IMAGE"), bytes, {}, dropped);
    return !decoded;
  };
  EXPECT_FALSE(refused("mono8", 8));
  EXPECT_FALSE(refused("bgr8", 24));
  EXPECT_FALSE(refused("jpeg", 5));
  EXPECT_TRUE(refused("mono8", 7));
  EXPECT_TRUE(refused("bgr8", 8));
  EXPECT_TRUE(refused("jpeg", 0));
  EXPECT_TRUE(refused("png", 24));
  image.width_px = 2;  // As many bytes, but not the picture that the intrinsics are for.
  image.height_px = 4;
  EXPECT_TRUE(refused("mono8", 8));
  EXPECT_TRUE(refused("jpeg", 5));
}

}  // namespace
}  // namespace v2vouch::wire
