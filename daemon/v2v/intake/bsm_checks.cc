// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/bsm_checks.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/kinematic_limits.h"

namespace v2vouch {
namespace {

// What no road vehicle does (check implausible).
constexpr double kMaxYawRate_radps = 1.5;
constexpr double kMaxTurning_mps2 = kMostRoadAccel_mps2;  // Speed x yaw rate.
constexpr double kEchoSpeed_mps = 1.0;
constexpr double kEchoCourse_rad = FromDegrees(15.0);
constexpr double kEchoCourseSpeed_mps = 2.0;  // Below, courses say little.

bool IsFinite(const std::optional<double>& value) { return !value || std::isfinite(*value); }

}  // namespace

std::optional<Refusal> ContentProblem(const Bsm& bsm) {
  const auto refuse = [](Reason reason, std::string_view field) { return Refusal{reason, field}; };
  if (bsm.signature == SignatureState::kInvalid) {
    return refuse(Reason::kBsmSignature, "signature_state");
  }
  if (!bsm.latitude_rad) return refuse(Reason::kBsmUnavailable, "lat");
  if (!bsm.longitude_rad) return refuse(Reason::kBsmUnavailable, "long_");
  if (!bsm.speed_mps) return refuse(Reason::kBsmUnavailable, "speed");
  const std::pair<const std::optional<double>*, std::string_view> figures[] = {
      {&bsm.latitude_rad, "lat"},
      {&bsm.longitude_rad, "long_"},
      {&bsm.elevation_m, "elev"},
      {&bsm.semi_major_m, "semiMajor"},
      {&bsm.speed_mps, "speed"},
      {&bsm.course_rad, "heading"},
      {&bsm.accel_long_mps2, "accelSet_long"},
      {&bsm.accel_lat_mps2, "accelSet_lat"},
      {&bsm.yaw_rate_radps, "accelSet_yaw"},
      {&bsm.length_m, "length"},
      {&bsm.width_m, "width"}};
  for (const auto& [value, field] : figures) {
    if (!IsFinite(*value)) return refuse(Reason::kNotFinite, field);
  }
  if (std::abs(*bsm.latitude_rad) > kPi / 2.0) return refuse(Reason::kBsmRange, "lat");
  if (std::abs(*bsm.longitude_rad) > 2.0 * kPi) return refuse(Reason::kBsmRange, "long_");
  if (std::abs(*bsm.speed_mps) > kMostRoadSpeed_mps)
    return refuse(Reason::kBsmImplausible, "speed");
  if (std::abs(bsm.accel_long_mps2.value_or(0.0)) > kMostRoadAccel_mps2) {
    return refuse(Reason::kBsmImplausible, "accelSet_long");
  }
  if (std::abs(bsm.accel_lat_mps2.value_or(0.0)) > kMostLateralAccel_mps2) {
    return refuse(Reason::kBsmImplausible, "accelSet_lat");
  }
  return std::nullopt;
}

double ClaimedAge(const Bsm& bsm, const IntakeConfig& config) {
  const Timestamp near = bsm.generation.value_or(bsm.stamp);
  if (!bsm.sec_mark_ms) {
    return bsm.generation ? ToSeconds(bsm.stamp - near) : config.default_age_s;
  }
  // The leap second, 60000 to 60999, shares its count of UTC microseconds with the first second of
  // the next minute.
  constexpr std::int64_t kMinute_us = 60'000'000;
  const std::int64_t claimed_us = std::int64_t{*bsm.sec_mark_ms} * 1000 % kMinute_us;
  std::int64_t before_us = (ToMicros(near) - claimed_us) % kMinute_us;
  if (before_us < 0) before_us += kMinute_us;
  if (before_us > kMinute_us / 2) before_us -= kMinute_us;
  return ToSeconds(bsm.stamp - near) + static_cast<double>(before_us) * 1e-6;
}

Claim ToClaim(const Bsm& bsm, double age_s, const IntakeConfig& config) {
  Claim claim;
  claim.sender = bsm.sender;
  claim.certificate = bsm.certificate;
  claim.received = bsm.stamp;
  claim.age_s = std::max(0.0, age_s);  // Clocks differ by a little.
  claim.has_elevation = bsm.elevation_m.has_value();
  claim.height_m = bsm.elevation_m.value_or(0.0);
  // A sender of unknown height is put at 0: everything that compares places does so along the
  // vertical, and so the claim stays a function of the message alone.
  const Wgs84 place{*bsm.latitude_rad, *bsm.longitude_rad, claim.height_m};
  claim.p_E = ToEcef(place).p_E;

  // J2735 gives the direction of motion and a speed without sign; ours is the vehicle's x axis.
  const bool is_reverse = bsm.transmission == Transmission::kReverse;
  claim.speed_mps = is_reverse ? -*bsm.speed_mps : *bsm.speed_mps;
  claim.has_course = bsm.course_rad.has_value();
  if (claim.has_course) {
    const double yaw = *bsm.course_rad + (is_reverse ? kPi : 0.0);
    const Eigen::Matrix3d R_EN = EastNorthUp(place);
    claim.course_E = std::cos(yaw) * R_EN.col(0) + std::sin(yaw) * R_EN.col(1);
  }
  claim.accel_mps2 = bsm.accel_long_mps2.value_or(0.0);
  const double yaw_rate = bsm.yaw_rate_radps.value_or(0.0);
  const bool is_possible = std::abs(yaw_rate) <= kMaxYawRate_radps &&
                           std::abs(yaw_rate * claim.speed_mps) <= kMaxTurning_mps2;
  claim.yaw_rate_radps = is_possible ? yaw_rate : 0.0;
  claim.position_sigma_m =
      bsm.semi_major_m
          ? std::clamp(*bsm.semi_major_m, config.min_position_sigma_m,
                       std::max(config.min_position_sigma_m, config.max_position_sigma_m))
          : config.unknown_position_sigma_m;
  claim.accuracy_is_poor = bsm.semi_major_m.value_or(0.0) > config.usable_position_sigma_m;
  claim.length_m = bsm.length_m;
  claim.width_m = bsm.width_m;
  claim.events = bsm.events;
  return claim;
}

bool IsOwnEcho(const Claim& claim, const EgoPlace& ego, const IntakeConfig& config) {
  if (config.own_id != 0 && claim.sender == config.own_id) return true;
  const Eigen::Vector3d now_E =
      claim.p_E + (claim.has_course ? claim.speed_mps * claim.age_s : 0.0) * claim.course_E;
  if (HorizontalDistance(ego.p_E, now_E) > config.own_echo_m) return false;
  if (std::abs(claim.speed_mps - ego.speed_mps) > kEchoSpeed_mps) return false;
  if (!claim.has_course || std::abs(ego.speed_mps) < kEchoCourseSpeed_mps) return true;
  return claim.course_E.dot(ego.course_E) > std::cos(kEchoCourse_rad);
}

}  // namespace v2vouch
