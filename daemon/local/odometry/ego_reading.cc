// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/odometry/ego_reading.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

// Of a yaw rate that is 0 because the car stands.
constexpr double kHeldSigma_radps = 1e-4;
constexpr double kDopplerSigma_mps = 0.1;
constexpr double kTellOffset_radps = FromDegrees(0.1);  // 6 degrees a minute.

}  // namespace

EgoMotion EgoReading::Read(const EgoMotion& sample) {
  newest_ = sample;
  EgoMotion read = sample;
  const double speed_mps = speed_.Read(sample);
  const SpeedCorrection correction =
      config_.check_speed ? speed_.correction() : SpeedCorrection::kNone;
  if (correction != SpeedCorrection::kNone) {
    read.speed_mps = speed_mps;
    // Its acceleration may come from the same wheels.
    read.accel_long_mps2.reset();
    const bool is_doppler =
        correction == SpeedCorrection::kDeadband || correction == SpeedCorrection::kFrozen;
    read.speed_sigma_mps = is_doppler
                               ? std::max(kDopplerSigma_mps, sample.speed_sigma_mps)
                               : std::max(1.0, std::abs(speed_.factor())) * sample.speed_sigma_mps;
  }
  Standstill standstill = Standstill::kNo;
  if (speed_.still_s() >= GyroOffset::kSettle_s && !speed_.may_roll()) {
    standstill = speed_.is_seen_standing() ? Standstill::kSeen : Standstill::kWheels;
  }
  if (!sample.has_yaw_rate)
    return read;  // Nothing to learn from; the odometry goes on with the last.
  yaw_rate_radps_ = read.yaw_rate_radps;
  if (!config_.learn_gyro_offset) return read;
  read.yaw_rate_radps = gyro_.Read(sample.stamp, sample.yaw_rate_radps, standstill);
  if (gyro_.is_held()) {
    read.yaw_rate_sigma_radps = std::min(kHeldSigma_radps, sample.yaw_rate_sigma_radps);
  } else if (gyro_.is_learnt()) {
    read.yaw_rate_sigma_radps = std::hypot(sample.yaw_rate_sigma_radps, gyro_.sigma_radps());
  }
  yaw_rate_radps_ = read.yaw_rate_radps;
  return read;
}

std::optional<Timestamp> EgoReading::OnRadarScan(const RadarScan& scan, const RadarConfig& radar) {
  if (!config_.check_speed) return std::nullopt;
  world_.Read(scan, radar, yaw_rate_radps_);
  speed_.OnScan(scan.stamp, world_);
  yaw_.OnScan(scan.stamp, world_, speed_.used_speed_mps());
  return speed_.misread_since();
}

void EgoReading::CollectNotices(std::vector<Notice>& notices) const {
  const auto add = [&](NoticeKind kind, double value) {
    notices.push_back({kind, {NoticeSubject::Kind::kEgoMotion, 0}, value});
  };
  if (gyro_.is_learnt() && std::abs(gyro_.offset_radps()) >= kTellOffset_radps) {
    add(NoticeKind::kGyroOffset, ToDegrees(gyro_.offset_radps()));
  }
  if (!config_.check_speed) return;
  const double told_mps = speed_.reported_speed_mps();
  if (speed_.gear_contradicts()) add(NoticeKind::kGearContradicts, told_mps);
  switch (speed_.correction()) {
    case SpeedCorrection::kNone:
      break;
    case SpeedCorrection::kDeadband:
      add(NoticeKind::kSpeedDeadband, speed_.doppler_speed_mps());
      break;
    case SpeedCorrection::kSign:
      add(NoticeKind::kSpeedSign, told_mps);
      break;
    case SpeedCorrection::kScale:
      add(NoticeKind::kSpeedScale, speed_.factor());
      break;
    case SpeedCorrection::kFrozen:
      add(NoticeKind::kSpeedFrozen, speed_.doppler_speed_mps());
      break;
  }
  if (speed_.is_suspect()) add(NoticeKind::kSpeedSuspect, speed_.doppler_speed_mps());
  if (yaw_.is_suspect()) add(NoticeKind::kYawRateSuspect, ToDegrees(yaw_.missing_radps()));
}

}  // namespace v2vouch
