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
// Of an object: an oversize transport, and more than any road vehicle drives.
constexpr double kMaxLength_m = 40.0;
constexpr double kMaxWidth_m = 10.0;
constexpr double kMaxObjectSpeed_mps = 150.0;
// Variances: a position that is off by more than 100 m tells nothing, and none is known to a
// tenth of a millimetre. A correlation nearer to one than this leaves no ellipse.
constexpr double kMaxObjectVariance = 1e4;
constexpr double kLeastVariance = 1e-8;
constexpr double kMostCorrelation = 0.999;
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
double Score(double score, std::string_view field, std::string_view percent_field,
             FieldJudge& judge) {
  if (std::isnan(score) || score == 0.0) return 1.0;
  if (score > 0.0 && score <= 1.0 + kScoreRounding) return std::min(score, 1.0);
  if (score > 1.0 && score <= 100.0) {
    judge.Unused(percent_field);
    return score / 100.0;
  }
  judge.Unused(field);
  return 1.0;
}

// What a detector calls its box; nullopt: no road user, the box is left out.
std::optional<ObjectClass> Class(const std::string& name, std::string_view field,
                                 RefusalTally& dropped) {
  const NamedClass named = MeaningOf(name);
  if (!named.is_known || !named.is_road_user) {
    dropped.AddNamed({named.is_road_user ? Reason::kFieldUnused : Reason::kOutOfRange, field},
                     Printable(name));
    if (!named.is_road_user) return std::nullopt;
  }
  return named.object_class;
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

// Axis and size. A size is told as a whole or not at all.
void PutShape(const object_t& from, FieldJudge& judge, ObjectBox& object) {
  const auto yaw = judge.Optional(
      from.yaw_rad, -kTurn_rad, kTurn_rad,
      LooksLikeDegrees(from.yaw_rad) ? "objects.yaw_rad looks like degrees" : "objects.yaw_rad");
  object.has_yaw = yaw.has_value();
  object.yaw_rad = WrapAngle(yaw.value_or(0.0));
  if (from.has_front != 0 && from.has_front != 1) judge.Unused("objects.has_front");
  object.has_front = from.has_front == 1 && object.has_yaw;
  const auto size = [&judge](double value, double least, double most, std::string_view field) {
    return value == 0.0 ? std::nullopt : judge.Optional(value, least, most, field);
  };
  const auto length = size(from.length_m, 0.1, kMaxLength_m, "objects.length_m");
  const auto width = size(from.width_m, 0.1, kMaxWidth_m, "objects.width_m");
  object.has_size = length && width;
  if (!object.has_size) return;
  object.length_m = *length;
  object.width_m = *width;
}

void PutVelocity(const object_t& from, FieldJudge& judge, ObjectBox& object) {
  const auto x = judge.Optional(from.velocity_x_mps, -kMaxObjectSpeed_mps, kMaxObjectSpeed_mps,
                                "objects.velocity_x_mps");
  const auto y = judge.Optional(from.velocity_y_mps, -kMaxObjectSpeed_mps, kMaxObjectSpeed_mps,
                                "objects.velocity_y_mps");
  if (x && y) object.velocity_mps = Eigen::Vector2d(*x, *y);
}

// Variance i of an object's covariance; 0: unknown.
double Variance(const object_t& from, int i, FieldJudge& judge) {
  const double variance = from.covariance[6 * i];
  if (variance > 0.0 && variance <= kMaxObjectVariance) return std::max(variance, kLeastVariance);
  if (variance != 0.0 && !std::isnan(variance)) judge.Unused("objects.covariance");
  return 0.0;
}

// Of the i-th figure and the next. Where only one of the two is known it goes for both; a
// correlation that cannot be counts as none.
Eigen::Matrix2d Covariance(const object_t& from, int i, FieldJudge& judge) {
  Eigen::Matrix2d P = Eigen::Matrix2d::Zero();
  P(0, 0) = Variance(from, i, judge);
  P(1, 1) = Variance(from, i + 1, judge);
  if (P(0, 0) == 0.0) P(0, 0) = P(1, 1);
  if (P(1, 1) == 0.0) P(1, 1) = P(0, 0);
  const double upper = from.covariance[5 * i + i + 1];
  const double lower = from.covariance[5 * (i + 1) + i];
  if (std::isnan(upper) || std::isnan(lower)) return P;
  const double scale = std::sqrt(P(0, 0) * P(1, 1));
  const double mean = 0.5 * (upper + lower);
  const bool is_symmetric = std::abs(upper - lower) <= 1e-6 * (1.0 + scale);
  if (is_symmetric && std::abs(mean) <= kMostCorrelation * scale) {
    P(0, 1) = P(1, 0) = mean;
  } else if (scale > 0.0) {
    judge.Unused("objects.covariance");
  }
  return P;
}

void PutCovariances(const object_t& from, FieldJudge& judge, ObjectBox& object) {
  object.position_covariance = Covariance(from, 0, judge);
  object.yaw_sigma_rad = std::sqrt(Variance(from, 2, judge));
  object.velocity_covariance = Covariance(from, 3, judge);
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
    const auto object_class = Class(from.class_name, "boxes.class_name", dropped);
    if (!object_class) continue;
    detections.boxes.push_back({
        .left_px = from.left_px,
        .top_px = from.top_px,
        .width_px = from.width_px,
        .height_px = from.height_px,
        .object_class = *object_class,
        .score = Score(from.score, "boxes.score", "boxes.score looks like percent", each),
    });
  }
  return detections;
}

Result<ObjectList> FromWire(const object_list_t& message, const ObjectSensorConfig& source,
                            int index, Timestamp received, RefusalTally& dropped) {
  FieldJudge judge(dropped);
  JudgeSensor(message.sensor, source.name, judge);
  JudgeTime(message, received, judge);
  if (judge.refusal()) return *judge.refusal();

  ObjectList list;
  static_cast<MessageHeader&>(list) = Header(message, source.clock_offset_s, received);
  list.sensor = index;
  list.objects.reserve(message.objects.size());
  for (const object_t& from : message.objects) {
    FieldJudge each(dropped);
    each.Need(from.x_m, -kMaxRange_m, kMaxRange_m, "objects.x_m");
    each.Need(from.y_m, -kMaxRange_m, kMaxRange_m, "objects.y_m");
    if (each.refusal()) {
      dropped.Add(*each.refusal());
      continue;
    }
    const auto object_class = Class(from.class_name, "objects.class_name", dropped);
    if (!object_class) continue;
    ObjectBox& object = list.objects.emplace_back();
    object.x_m = from.x_m;
    object.y_m = from.y_m;
    object.object_class = *object_class;
    object.score = Score(from.score, "objects.score", "objects.score looks like percent", each);
    object.id = std::max<std::int64_t>(from.id, -1);
    PutShape(from, each, object);
    PutVelocity(from, each, object);
    PutCovariances(from, each, object);
  }
  return list;
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
