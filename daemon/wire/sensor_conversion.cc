// SPDX-License-Identifier: Apache-2.0
#include "daemon/wire/sensor_conversion.h"

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "daemon/base/angle.h"
#include "daemon/data/object_class.h"

namespace v2vouch::wire {
namespace {

// Bounds that no sensor of a road vehicle exceeds: past them a number is a fault, not a
// measurement.
constexpr double kMaxRange_m = 1000.0;
constexpr double kMaxRangeRate_mps = 200.0;
constexpr double kMaxSpeed_mps = 120.0;
constexpr double kMaxYawRate_radps = 10.0;
constexpr double kMaxAccel_mps2 = 100.0;
constexpr double kMaxSigma = 1000.0;
constexpr double kMaxPixel = 1e5;
constexpr double kMaxAltitude_m = 20000.0;

// Collects the first fault of a message; later checks of the same message are then of no matter.
class Judge {
 public:
  Judge& InRange(double value, double low, double high) {
    if (!reason_ && !std::isfinite(value)) reason_ = Reason::kNotFinite;
    if (!reason_ && (value < low || value > high)) reason_ = Reason::kOutOfRange;
    return *this;
  }
  Judge& NaNOrInRange(double value, double low, double high) {
    return std::isnan(value) ? *this : InRange(value, low, high);
  }
  Judge& Sigma(double value) {
    if (!reason_ && std::isfinite(value) && value <= 0.0) reason_ = Reason::kOutOfRange;
    return InRange(value, 0.0, kMaxSigma);
  }
  Judge& Holds(bool condition, Reason otherwise) {
    if (!reason_ && !condition) reason_ = otherwise;
    return *this;
  }
  [[nodiscard]] std::optional<Reason> reason() const { return reason_; }

 private:
  std::optional<Reason> reason_;
};

void Count(ReasonCounts& counts, Reason reason) { ++counts[static_cast<std::size_t>(reason)]; }

std::optional<double> Available(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

template <class Message>
MessageHeader Header(const Message& message, double clock_offset_s, Timestamp received) {
  return {FromMicros(message.utime) + FromSeconds(clock_offset_s), received, message.seq};
}

// What detectors trained on COCO call them.
constexpr std::pair<std::string_view, ObjectClass> kOtherNames[] = {
    {"motorbike", ObjectClass::kMotorcycle},
    {"person", ObjectClass::kPedestrian},
    {"bicycle", ObjectClass::kCyclist}};

}  // namespace

bool IsPlausibleTime(std::int64_t utime) {
  constexpr std::int64_t kYear2200 = 7'258'118'400'000'000;
  return utime > 0 && utime < kYear2200;
}

ObjectClass ClassOfName(std::string_view name) {
  for (const auto& [known, object_class] : kOtherNames) {
    if (known == name) return object_class;
  }
  return ObjectClassOf(name).value_or(ObjectClass::kUnknown);
}

Result<RadarScan> FromWire(const radar_scan_t& message, const RadarConfig& radar, int index,
                           Timestamp received, ReasonCounts& dropped) {
  Judge judge;
  judge.Holds(message.sensor == radar.name, Reason::kSensorMismatch)
      .Holds(IsPlausibleTime(message.utime) && message.seq >= 0, Reason::kOutOfRange);
  if (judge.reason()) return *judge.reason();

  RadarScan scan;
  static_cast<MessageHeader&>(scan) = Header(message, radar.clock_offset_s, received);
  scan.radar = index;
  scan.detections.reserve(message.detections.size());
  for (const radar_detection_t& from : message.detections) {
    const double range_m = from.range_m + radar.range_offset_m;
    Judge each;
    each.InRange(range_m, 0.0, kMaxRange_m)
        .Holds(range_m > 0.0, Reason::kOutOfRange)
        .InRange(from.azimuth_rad, -kPi - 1e-9, kPi + 1e-9)
        .InRange(from.range_rate_mps, -kMaxRangeRate_mps, kMaxRangeRate_mps)
        .NaNOrInRange(from.rcs_dbsm, -200.0, 200.0)
        .NaNOrInRange(from.snr_db, -200.0, 300.0)
        .Holds(from.track_id >= -1, Reason::kOutOfRange);
    if (each.reason()) {
      Count(dropped, *each.reason());
      continue;
    }
    scan.detections.push_back({
        .range_m = range_m,
        .azimuth_rad = WrapAngle(radar.flip_azimuth ? -from.azimuth_rad : from.azimuth_rad),
        .range_rate_mps = radar.flip_range_rate ? -from.range_rate_mps : from.range_rate_mps,
        .rcs_dbsm = from.rcs_dbsm,
        .snr_db = from.snr_db,
        .track_id = from.track_id,
    });
  }
  return scan;
}

Result<CameraDetections> FromWire(const camera_detections_t& message, const CameraConfig& camera,
                                  int index, Timestamp received, ReasonCounts& dropped) {
  // Pixels of another resolution than the intrinsics are for would mean other angles.
  const bool has_size = message.image_width_px == camera.image_width_px &&
                        message.image_height_px == camera.image_height_px;
  Judge judge;
  judge.Holds(message.sensor == camera.name, Reason::kSensorMismatch)
      .Holds(IsPlausibleTime(message.utime) && message.seq >= 0, Reason::kOutOfRange)
      .Holds(has_size, Reason::kOutOfRange);
  if (judge.reason()) return *judge.reason();

  CameraDetections detections;
  static_cast<MessageHeader&>(detections) = Header(message, camera.clock_offset_s, received);
  detections.camera = index;
  detections.image_width_px = message.image_width_px;
  detections.image_height_px = message.image_height_px;
  detections.boxes.reserve(message.boxes.size());
  for (const camera_box_t& from : message.boxes) {
    Judge each;
    each.InRange(from.left_px, -kMaxPixel, kMaxPixel)
        .InRange(from.top_px, -kMaxPixel, kMaxPixel)
        .InRange(from.width_px, 0.0, kMaxPixel)
        .InRange(from.height_px, 0.0, kMaxPixel)
        .Holds(from.width_px > 0.0 && from.height_px > 0.0, Reason::kOutOfRange)
        .InRange(from.score, 0.0, 1.0);
    if (each.reason()) {
      Count(dropped, *each.reason());
      continue;
    }
    detections.boxes.push_back({
        .left_px = from.left_px,
        .top_px = from.top_px,
        .width_px = from.width_px,
        .height_px = from.height_px,
        .object_class = ClassOfName(from.class_name),
        .score = from.score,
    });
  }
  return detections;
}

Result<EgoMotion> FromWire(const ego_motion_t& message, const VehicleConfig& vehicle,
                           Timestamp received) {
  const int gear = message.gear;
  const bool has_accel = !std::isnan(message.accel_long_mps2);
  const bool has_lateral = !std::isnan(message.accel_lat_mps2);
  Judge judge;
  judge.Holds(IsPlausibleTime(message.utime) && message.seq >= 0, Reason::kOutOfRange)
      .InRange(message.speed_mps, -kMaxSpeed_mps, kMaxSpeed_mps)
      .Sigma(message.speed_sigma_mps)
      .InRange(message.yaw_rate_radps, -kMaxYawRate_radps, kMaxYawRate_radps)
      .Sigma(message.yaw_rate_sigma_radps)
      .Holds((gear >= 0 && gear <= 3) || gear == 7, Reason::kOutOfRange);
  if (has_accel) judge.InRange(message.accel_long_mps2, -kMaxAccel_mps2, kMaxAccel_mps2);
  if (has_lateral) judge.InRange(message.accel_lat_mps2, -kMaxAccel_mps2, kMaxAccel_mps2);
  if (judge.reason()) return *judge.reason();

  EgoMotion ego;
  static_cast<MessageHeader&>(ego) = Header(message, 0.0, received);
  ego.speed_mps = message.speed_mps / vehicle.speed_scale;
  ego.speed_sigma_mps = message.speed_sigma_mps / vehicle.speed_scale;
  ego.yaw_rate_radps = message.yaw_rate_radps - vehicle.yaw_rate_bias_radps;
  ego.yaw_rate_sigma_radps = message.yaw_rate_sigma_radps;
  ego.accel_long_mps2 = Available(message.accel_long_mps2);
  ego.accel_lat_mps2 = Available(message.accel_lat_mps2);
  ego.gear = static_cast<Gear>(message.gear);
  return ego;
}

Result<GnssFix> FromWire(const gnss_fix_t& message, const VehicleConfig& vehicle,
                         Timestamp received) {
  const bool has_yaw = !std::isnan(message.heading_rad);
  const bool has_velocity =
      !std::isnan(message.velocity_east_mps) && !std::isnan(message.velocity_north_mps);
  const int fix = message.fix_type;
  Judge judge;
  judge.Holds(IsPlausibleTime(message.utime) && message.seq >= 0, Reason::kOutOfRange)
      .Holds(fix == 0 || (fix >= 2 && fix <= 6), Reason::kOutOfRange)
      .InRange(message.latitude_rad, -kPi / 2.0, kPi / 2.0)
      .InRange(message.longitude_rad, -kPi, kPi)
      .NaNOrInRange(message.altitude_m, -1000.0, kMaxAltitude_m)
      .NaNOrInRange(message.velocity_up_mps, -kMaxSpeed_mps, kMaxSpeed_mps);
  for (const double element : message.covariance_enu_m2) judge.InRange(element, -1e12, 1e12);
  if (has_yaw)
    judge.InRange(message.heading_rad, 0.0, 2.0 * kPi + 1e-9).Sigma(message.heading_sigma_rad);
  if (has_velocity) {
    judge.InRange(message.velocity_east_mps, -kMaxSpeed_mps, kMaxSpeed_mps)
        .InRange(message.velocity_north_mps, -kMaxSpeed_mps, kMaxSpeed_mps)
        .Sigma(message.velocity_sigma_mps);
  }
  GnssFix result;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      result.covariance_enu(row, column) = message.covariance_enu_m2[row * 3 + column];
    }
  }
  // Symmetric, variances not negative, correlations at most 1: what a covariance has to be.
  const Eigen::Matrix3d& P = result.covariance_enu;
  for (int i = 0; i < 3; ++i) {
    judge.Holds(P(i, i) >= 0.0, Reason::kOutOfRange);
    for (int j = 0; j < i; ++j) {
      const double scale = P(i, i) * P(j, j);
      judge.Holds(std::abs(P(i, j) - P(j, i)) <= 1e-6 * (1.0 + std::sqrt(std::abs(scale))),
                  Reason::kOutOfRange);
      judge.Holds(P(i, j) * P(i, j) <= scale * (1.0 + 1e-6) + 1e-12, Reason::kOutOfRange);
    }
  }
  if (judge.reason()) return *judge.reason();

  static_cast<MessageHeader&>(result) = Header(message, 0.0, received);
  result.position.latitude_rad = message.latitude_rad;
  result.position.longitude_rad = message.longitude_rad;
  result.position.height_m = Available(message.altitude_m).value_or(0.0);
  if (has_yaw) {
    result.yaw_rad = WrapAngle(kPi / 2.0 - message.heading_rad - vehicle.heading_bias_rad);
    result.yaw_sigma_rad = message.heading_sigma_rad;
  }
  if (has_velocity) {
    result.velocity_en_mps = Eigen::Vector2d(message.velocity_east_mps, message.velocity_north_mps);
    result.velocity_sigma_mps = message.velocity_sigma_mps;
  }
  result.fix_type = static_cast<FixType>(message.fix_type);
  return result;
}

}  // namespace v2vouch::wire
