// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>

#include "daemon/rim/wire/message_parts.h"
#include "daemon/rim/wire/sensor_conversion.h"

namespace v2vouch::wire {
namespace {

// Bounds that no road vehicle exceeds: past them a number is a fault, not a measurement.
constexpr double kMaxSpeed_mps = 120.0;
constexpr double kMaxYawRate_radps = 10.0;
constexpr double kMaxAccel_mps2 = 100.0;
constexpr double kMaxSigma = 1000.0;
constexpr double kMinAltitude_m = -1000.0;
constexpr double kMaxAltitude_m = 20000.0;
constexpr double kMaxVariance_m2 = 1e12;
// An uncertain yaw rate: a car that may be turning [rad/s].
constexpr double kUnknownYawRateSigma_radps = 0.1;
// A fix nearer to 0 N 0 E than this (0.6 m) was never measured: that is what receivers send who
// have none yet.
constexpr double kNullIsland_rad = 1e-7;

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
  // Exactly due north and without accuracy: the field was not filled in.
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
