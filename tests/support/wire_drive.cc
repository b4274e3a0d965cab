// SPDX-License-Identifier: Apache-2.0
#include "tests/support/wire_drive.h"

#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/object_class.h"
#include "daemon/rim/wire/codec.h"
#include "daemon/rim/wire/output_encoder.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/object_list_t.hpp"
#include "v2vouch/radar_scan_t.hpp"

namespace v2vouch::testing {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <class T>
T Rounded(double value) {
  return static_cast<T>(std::llround(value));
}

double HeadingFromNorth(double yaw_rad) {
  const double heading = WrapAngle(kPi / 2.0 - yaw_rad);
  return heading < 0.0 ? heading + 2.0 * kPi : heading;
}

WireMessage Encode(const RadarScan& scan, const VehicleConfig& vehicle) {
  radar_scan_t message{};
  message.utime = ToMicros(scan.stamp);
  message.seq = scan.seq;
  message.sensor = vehicle.radars[static_cast<std::size_t>(scan.radar)].name;
  for (const RadarDetection& from : scan.detections) {
    radar_detection_t to{};
    to.range_m = from.range_m;
    to.azimuth_rad = from.azimuth_rad;
    to.range_rate_mps = from.range_rate_mps;
    to.rcs_dbsm = from.rcs_dbsm;
    to.snr_db = from.snr_db;
    to.track_id = from.track_id;
    message.detections.push_back(to);
  }
  message.num_detections = static_cast<std::int32_t>(message.detections.size());
  WireMessage result{"RADAR_" + message.sensor, {}, scan.stamp};
  wire::Encode(message, result.bytes);
  return result;
}

WireMessage Encode(const CameraDetections& boxes, const VehicleConfig& vehicle) {
  const CameraConfig& camera = vehicle.cameras[static_cast<std::size_t>(boxes.camera)];
  WireMessage result{"CAMERA_" + camera.name, {}, boxes.stamp};
  wire::EncodeDetections(boxes, camera, result.bytes);
  return result;
}

WireMessage Encode(const ObjectList& list, const VehicleConfig& vehicle) {
  object_list_t message{};
  message.utime = ToMicros(list.stamp);
  message.seq = list.seq;
  message.sensor = vehicle.objects[static_cast<std::size_t>(list.sensor)].name;
  for (const ObjectBox& from : list.objects) {
    object_t to{};
    to.x_m = from.x_m;
    to.y_m = from.y_m;
    to.yaw_rad = from.has_yaw ? from.yaw_rad : kNaN;
    to.has_front = from.has_front ? 1 : 0;
    to.length_m = from.has_size ? from.length_m : kNaN;
    to.width_m = from.has_size ? from.width_m : kNaN;
    to.velocity_x_mps = from.velocity_mps ? from.velocity_mps->x() : kNaN;
    to.velocity_y_mps = from.velocity_mps ? from.velocity_mps->y() : kNaN;
    to.class_name = std::string(ObjectClassName(from.object_class));
    to.score = from.score;
    to.id = from.id;
    message.objects.push_back(to);
  }
  message.num_objects = static_cast<std::int32_t>(message.objects.size());
  WireMessage result{"OBJECTS_" + message.sensor, {}, list.stamp};
  wire::Encode(message, result.bytes);
  return result;
}

WireMessage Encode(const EgoMotion& ego, const VehicleConfig&) {
  ego_motion_t message{};
  message.utime = ToMicros(ego.stamp);
  message.seq = ego.seq;
  message.speed_mps = ego.speed_mps;
  message.speed_sigma_mps = ego.speed_sigma_mps;
  message.yaw_rate_radps = ego.has_yaw_rate ? ego.yaw_rate_radps : kNaN;
  message.yaw_rate_sigma_radps = ego.yaw_rate_sigma_radps;
  message.accel_long_mps2 = ego.accel_long_mps2.value_or(kNaN);
  message.accel_long_sigma_mps2 = 0.1;
  message.accel_lat_mps2 = ego.accel_lat_mps2.value_or(kNaN);
  message.accel_lat_sigma_mps2 = 0.1;
  message.gear = static_cast<std::int8_t>(ego.gear);
  WireMessage result{"EGO_MOTION", {}, ego.stamp};
  wire::Encode(message, result.bytes);
  return result;
}

WireMessage Encode(const GnssFix& fix, const VehicleConfig&) {
  gnss_fix_t message{};
  message.utime = ToMicros(fix.stamp);
  message.seq = fix.seq;
  message.latitude_rad = fix.position.latitude_rad;
  message.longitude_rad = fix.position.longitude_rad;
  message.altitude_m = fix.has_height ? fix.position.height_m : kNaN;
  for (int i = 0; i < 9; ++i) message.covariance_enu_m2[i] = fix.covariance_enu(i / 3, i % 3);
  message.heading_rad = fix.yaw_rad ? HeadingFromNorth(*fix.yaw_rad) : kNaN;
  message.heading_sigma_rad = fix.yaw_sigma_rad;
  message.velocity_east_mps = fix.velocity_en_mps ? fix.velocity_en_mps->x() : kNaN;
  message.velocity_north_mps = fix.velocity_en_mps ? fix.velocity_en_mps->y() : kNaN;
  message.velocity_up_mps = kNaN;
  message.velocity_sigma_mps = fix.velocity_sigma_mps;
  message.fix_type = static_cast<std::int8_t>(fix.fix_type);
  WireMessage result{"EGO_GNSS", {}, fix.stamp};
  wire::Encode(message, result.bytes);
  return result;
}

WireMessage Encode(const Bsm& bsm, const VehicleConfig&) {
  bsm_t message{};
  message.rx_utime = ToMicros(bsm.stamp);
  message.generation_utime = bsm.generation ? ToMicros(*bsm.generation) : 0;
  message.seq = bsm.seq;
  message.msgCnt = static_cast<std::int16_t>(bsm.msg_count);
  for (int i = 0; i < 4; ++i) message.id[i] = static_cast<std::uint8_t>(bsm.sender >> (24 - 8 * i));
  message.secMark = bsm.sec_mark_ms.value_or(65535);
  message.lat =
      bsm.latitude_rad ? Rounded<std::int32_t>(ToDegrees(*bsm.latitude_rad) * 1e7) : 900000001;
  message.long_ =
      bsm.longitude_rad ? Rounded<std::int32_t>(ToDegrees(*bsm.longitude_rad) * 1e7) : 1800000001;
  message.elev = bsm.elevation_m ? Rounded<std::int32_t>(*bsm.elevation_m * 10.0) : -4096;
  message.semiMajor = bsm.semi_major_m ? Rounded<std::int16_t>(*bsm.semi_major_m / 0.05) : 255;
  message.semiMinor = bsm.semi_minor_m ? Rounded<std::int16_t>(*bsm.semi_minor_m / 0.05) : 255;
  message.orientation = 65535;
  message.transmission = static_cast<std::int8_t>(bsm.transmission);
  message.speed = bsm.speed_mps ? Rounded<std::int16_t>(*bsm.speed_mps / 0.02) : 8191;
  message.heading =
      bsm.course_rad
          ? Rounded<std::int32_t>(ToDegrees(HeadingFromNorth(*bsm.course_rad)) / 0.0125) % 28800
          : 28800;
  message.angle = 127;
  message.accelSet_long =
      bsm.accel_long_mps2 ? Rounded<std::int16_t>(*bsm.accel_long_mps2 / 0.01) : 2001;
  message.accelSet_lat = 2001;
  message.accelSet_vert = -127;
  message.accelSet_yaw =
      bsm.yaw_rate_radps ? Rounded<std::int32_t>(-ToDegrees(*bsm.yaw_rate_radps) / 0.01) : 0;
  message.width = bsm.width_m ? Rounded<std::int16_t>(*bsm.width_m / 0.01) : 0;
  message.length = bsm.length_m ? Rounded<std::int16_t>(*bsm.length_m / 0.01) : 0;
  message.signature_state = static_cast<std::int8_t>(bsm.signature);
  message.rssi_dbm = static_cast<float>(bsm.rssi_dbm);
  WireMessage result{"BSM", {}, bsm.stamp};
  wire::Encode(message, result.bytes);
  return result;
}

}  // namespace

std::vector<WireMessage> EncodeInputs(const std::vector<Input>& inputs,
                                      const VehicleConfig& vehicle) {
  std::vector<WireMessage> messages;
  messages.reserve(inputs.size());
  for (const Input& input : inputs) {
    messages.push_back(
        std::visit([&](const auto& message) { return Encode(message, vehicle); }, input));
  }
  return messages;
}

}  // namespace v2vouch::testing
