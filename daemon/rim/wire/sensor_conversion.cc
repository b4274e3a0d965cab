// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/sensor_conversion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "daemon/common/base/angle.h"
#include "daemon/rim/wire/class_names.h"
#include "daemon/rim/wire/field_judge.h"

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
constexpr double kMinAltitude_m = -1000.0;
constexpr double kMaxAltitude_m = 20000.0;
constexpr double kMaxVariance_m2 = 1e12;
// Angles may be counted from -pi to pi or from 0 to 2 pi, in single precision.
constexpr double kTurn_rad = 2.0 * kPi + 1e-5;
constexpr double kScoreRounding = 0.01;
// An uncertain yaw rate: a car that may be turning [rad/s].
constexpr double kUnknownYawRateSigma_radps = 0.1;
// A fix nearer to 0 N 0 E than this (0.6 m) was never measured: that is what receivers send who
// have none yet.
constexpr double kNullIsland_rad = 1e-7;

template <class Message>
MessageHeader Header(const Message& message, double clock_offset_s, Timestamp received) {
  return {FromMicros(message.utime) + FromSeconds(clock_offset_s), received, SafeSeq(message.seq)};
}

template <class Message>
void JudgeTime(const Message& message, Timestamp received, FieldJudge& judge) {
  if (const auto fault = TimeFault(message.utime, received); !fault.empty()) {
    judge.Fail({Reason::kOutOfRange, fault});
  }
}

// The channel says which sensor speaks; a driver may leave the name inside empty.
void JudgeSensor(const std::string& name, const std::string& configured, FieldJudge& judge) {
  judge.Need(name.empty() || name == configured, {Reason::kSensorMismatch, "sensor"});
}

bool LooksLikeDegrees(double angle) {
  return std::abs(angle) > kTurn_rad && std::abs(angle) <= 360.0;
}

// A box without a score, or with 0, was published all the same: its detector is sure enough.
double Score(double score, FieldJudge& judge) {
  if (std::isnan(score) || score == 0.0) return 1.0;
  if (score > 0.0 && score <= 1.0 + kScoreRounding) return std::min(score, 1.0);
  if (score > 1.0 && score <= 100.0) {
    judge.Unused("boxes.score looks like percent");
    return score / 100.0;
  }
  judge.Unused("boxes.score");
  return 1.0;
}

FixType FixTypeOf(int raw, FieldJudge& judge) {
  if (raw >= 2 && raw <= 6) return static_cast<FixType>(raw);
  judge.Unused("fix_type");
  return FixType::k2d;  // There is a place; nothing more is sure.
}

// Whatever is no variance (NaN, 0, below 0, as drivers send where they do not know) stays 0, which
// is "unknown" further on; where only one of the two horizontal axes is known it goes for both.
// Correlations that cannot be count as none. nullopt: says that the place is worth nothing.
std::optional<Eigen::Matrix3d> Covariance(const double (&raw)[9], FieldJudge& judge) {
  constexpr std::string_view kField = "covariance_enu_m2";
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  bool is_odd = false;
  for (int i = 0; i < 3; ++i) {
    const double variance = raw[i * 3 + i];
    if (variance > kMaxVariance_m2 && i < 2) {
      judge.Fail({Reason::kGnssUnusable, kField});
      return std::nullopt;
    }
    const bool is_variance = variance > 0.0 && variance <= kMaxVariance_m2;
    P(i, i) = is_variance ? variance : 0.0;
    is_odd = is_odd || variance < 0.0;
  }
  if (P(0, 0) == 0.0) P(0, 0) = P(1, 1);
  if (P(1, 1) == 0.0) P(1, 1) = P(0, 0);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < i; ++j) {
      const double upper = raw[j * 3 + i];
      const double lower = raw[i * 3 + j];
      if (std::isnan(upper) || std::isnan(lower)) continue;
      const double scale = P(i, i) * P(j, j);
      const double mean = 0.5 * (upper + lower);
      const bool is_symmetric = std::abs(upper - lower) <= 1e-6 * (1.0 + std::sqrt(scale));
      if (is_symmetric && mean * mean <= scale * (1.0 + 1e-6)) {
        P(i, j) = P(j, i) = mean;
      } else if (scale > 0.0) {
        is_odd = true;
      }
    }
  }
  if (is_odd) judge.Unused(kField);
  return P;
}

}  // namespace

Result<RadarScan> FromWire(const radar_scan_t& message, const RadarConfig& radar, int index,
                           Timestamp received, RefusalTally& dropped) {
  FieldJudge judge(dropped);
  JudgeSensor(message.sensor, radar.name, judge);
  JudgeTime(message, received, judge);
  if (judge.refusal()) return *judge.refusal();

  RadarScan scan;
  static_cast<MessageHeader&>(scan) = Header(message, radar.clock_offset_s, received);
  scan.radar = index;
  scan.detections.reserve(message.detections.size());
  for (const radar_detection_t& from : message.detections) {
    const double range_m = from.range_m + radar.range_offset_m;
    FieldJudge each(dropped);
    each.Need(range_m, 0.0, kMaxRange_m, "detections.range_m");
    each.Need(range_m > 0.0, {Reason::kOutOfRange, "detections.range_m"});
    each.Need(from.azimuth_rad, -kTurn_rad, kTurn_rad,
              LooksLikeDegrees(from.azimuth_rad) ? "detections.azimuth_rad looks like degrees"
                                                 : "detections.azimuth_rad");
    each.Need(from.range_rate_mps, -kMaxRangeRate_mps, kMaxRangeRate_mps,
              "detections.range_rate_mps");
    if (each.refusal()) {
      dropped.Add(*each.refusal());
      continue;
    }
    scan.detections.push_back({
        .range_m = range_m,
        .azimuth_rad = WrapAngle(radar.flip_azimuth ? -from.azimuth_rad : from.azimuth_rad),
        .range_rate_mps = radar.flip_range_rate ? -from.range_rate_mps : from.range_rate_mps,
        .rcs_dbsm =
            each.Optional(from.rcs_dbsm, -200.0, 200.0, "detections.rcs_dbsm").value_or(kNaN),
        .snr_db = each.Optional(from.snr_db, -200.0, 300.0, "detections.snr_db").value_or(kNaN),
        .track_id = std::max(from.track_id, -1),
    });
  }
  return scan;
}

Result<CameraDetections> FromWire(const camera_detections_t& message, const CameraConfig& camera,
                                  int index, Timestamp received, RefusalTally& dropped) {
  FieldJudge judge(dropped);
  JudgeSensor(message.sensor, camera.name, judge);
  JudgeTime(message, received, judge);
  // Pixels of another resolution than the intrinsics are for would mean other angles. A driver that
  // does not know its own says 0.
  const auto is_size = [](int said, int configured) { return said == 0 || said == configured; };
  judge.Need(is_size(message.image_width_px, camera.image_width_px),
             {Reason::kOutOfRange, "image_width_px"});
  judge.Need(is_size(message.image_height_px, camera.image_height_px),
             {Reason::kOutOfRange, "image_height_px"});
  if (judge.refusal()) return *judge.refusal();

  CameraDetections detections;
  static_cast<MessageHeader&>(detections) = Header(message, camera.clock_offset_s, received);
  detections.camera = index;
  detections.image_width_px = camera.image_width_px;
  detections.image_height_px = camera.image_height_px;
  detections.boxes.reserve(message.boxes.size());
  for (const camera_box_t& from : message.boxes) {
    FieldJudge each(dropped);
    each.Need(from.left_px, -kMaxPixel, kMaxPixel, "boxes.left_px");
    each.Need(from.top_px, -kMaxPixel, kMaxPixel, "boxes.top_px");
    each.Need(from.width_px, 0.0, kMaxPixel, "boxes.width_px");
    each.Need(from.width_px > 0.0, {Reason::kOutOfRange, "boxes.width_px"});
    each.Need(from.height_px, 0.0, kMaxPixel, "boxes.height_px");
    each.Need(from.height_px > 0.0, {Reason::kOutOfRange, "boxes.height_px"});
    if (each.refusal()) {
      dropped.Add(*each.refusal());
      continue;
    }
    const NamedClass named = MeaningOf(from.class_name);
    if (!named.is_known || !named.is_road_user) {
      dropped.AddNamed(
          {named.is_road_user ? Reason::kFieldUnused : Reason::kOutOfRange, "boxes.class_name"},
          Printable(from.class_name));
      if (!named.is_road_user) continue;
    }
    detections.boxes.push_back({
        .left_px = from.left_px,
        .top_px = from.top_px,
        .width_px = from.width_px,
        .height_px = from.height_px,
        .object_class = named.object_class,
        .score = Score(from.score, each),
    });
  }
  return detections;
}

Result<EgoMotion> FromWire(const ego_motion_t& message, const VehicleConfig& vehicle,
                           Timestamp received, RefusalTally& unused) {
  FieldJudge judge(unused);
  JudgeTime(message, received, judge);
  judge.Need(message.speed_mps, -kMaxSpeed_mps, kMaxSpeed_mps, "speed_mps");
  if (judge.refusal()) return *judge.refusal();

  EgoMotion ego;
  static_cast<MessageHeader&>(ego) = Header(message, 0.0, received);
  ego.speed_mps = message.speed_mps / vehicle.speed_scale;
  if (const auto sigma = judge.Sigma(message.speed_sigma_mps, kMaxSigma, "speed_sigma_mps")) {
    ego.speed_sigma_mps = *sigma / vehicle.speed_scale;
  }
  const auto yaw_rate = judge.Optional(message.yaw_rate_radps, -kMaxYawRate_radps,
                                       kMaxYawRate_radps, "yaw_rate_radps");
  const auto yaw_rate_sigma =
      judge.Sigma(message.yaw_rate_sigma_radps, kMaxSigma, "yaw_rate_sigma_radps");
  if (yaw_rate) {
    ego.yaw_rate_radps = *yaw_rate - vehicle.yaw_rate_bias_radps;
    ego.yaw_rate_sigma_radps = yaw_rate_sigma.value_or(ego.yaw_rate_sigma_radps);
  } else {
    ego.has_yaw_rate = false;
    ego.yaw_rate_sigma_radps = kUnknownYawRateSigma_radps;
  }
  ego.accel_long_mps2 =
      judge.Optional(message.accel_long_mps2, -kMaxAccel_mps2, kMaxAccel_mps2, "accel_long_mps2");
  ego.accel_lat_mps2 =
      judge.Optional(message.accel_lat_mps2, -kMaxAccel_mps2, kMaxAccel_mps2, "accel_lat_mps2");
  const int gear = message.gear;
  const bool is_gear = (gear >= 0 && gear <= 3) || gear == 7;
  if (!is_gear) judge.Unused("gear");
  ego.gear = is_gear ? static_cast<Gear>(gear) : Gear::kUnknown;
  return ego;
}

Result<GnssFix> FromWire(const gnss_fix_t& message, const VehicleConfig& vehicle,
                         Timestamp received, RefusalTally& unused) {
  FieldJudge judge(unused);
  JudgeTime(message, received, judge);
  judge.Need(message.fix_type != 0, {Reason::kGnssUnusable, "fix_type"});
  const double latitude = message.latitude_rad;
  const double longitude = message.longitude_rad;
  const bool is_latitude_in_degrees = std::abs(latitude) > kPi / 2.0 && std::abs(latitude) <= 90.0;
  judge.Need(latitude, -kPi / 2.0, kPi / 2.0,
             is_latitude_in_degrees ? "latitude_rad looks like degrees" : "latitude_rad");
  judge.Need(longitude, -kTurn_rad, kTurn_rad,
             LooksLikeDegrees(longitude) ? "longitude_rad looks like degrees" : "longitude_rad");
  judge.Need(std::abs(latitude) > kNullIsland_rad || std::abs(longitude) > kNullIsland_rad,
             {Reason::kGnssUnusable, "latitude_rad and longitude_rad are 0"});
  if (judge.refusal()) return *judge.refusal();

  GnssFix fix;
  static_cast<MessageHeader&>(fix) = Header(message, 0.0, received);
  fix.position.latitude_rad = latitude;
  fix.position.longitude_rad = WrapAngle(longitude);
  const auto height =
      judge.Optional(message.altitude_m, kMinAltitude_m, kMaxAltitude_m, "altitude_m");
  fix.has_height = height.has_value();
  fix.position.height_m = height.value_or(0.0);
  const auto covariance = Covariance(message.covariance_enu_m2, judge);
  if (!covariance) return *judge.refusal();
  fix.covariance_enu = *covariance;

  const auto heading_sigma = judge.Sigma(message.heading_sigma_rad, kMaxSigma, "heading_sigma_rad");
  const auto heading = judge.Optional(
      message.heading_rad, -kTurn_rad, kTurn_rad,
      LooksLikeDegrees(message.heading_rad) ? "heading_rad looks like degrees" : "heading_rad");
  // Due north to the last bit and without accuracy: nobody filled the field in.
  const bool is_unset = message.heading_rad == 0.0 && !heading_sigma;
  if (heading && !is_unset) {
    fix.yaw_rad = WrapAngle(kPi / 2.0 - *heading - vehicle.heading_bias_rad);
    fix.yaw_sigma_rad = heading_sigma.value_or(kNaN);
  }
  const auto east =
      judge.Optional(message.velocity_east_mps, -kMaxSpeed_mps, kMaxSpeed_mps, "velocity_east_mps");
  const auto north = judge.Optional(message.velocity_north_mps, -kMaxSpeed_mps, kMaxSpeed_mps,
                                    "velocity_north_mps");
  const auto velocity_sigma =
      judge.Sigma(message.velocity_sigma_mps, kMaxSigma, "velocity_sigma_mps");
  if (east && north) {
    fix.velocity_en_mps = Eigen::Vector2d(*east, *north);
    fix.velocity_sigma_mps = velocity_sigma.value_or(kNaN);
  }
  fix.fix_type = FixTypeOf(message.fix_type, judge);
  return fix;
}

}  // namespace v2vouch::wire
