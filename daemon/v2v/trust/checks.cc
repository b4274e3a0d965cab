// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/checks.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

constexpr double kJitter_s = 0.05;  // Of a position's time, from message to message.
// Of a false velocity, by which the residual of the position must move with it; and of such a move,
// by which the two may differ.
constexpr double kConfirmedShare = 0.5;
// Share of the ego's own pose error that may come and go within ten seconds.
constexpr double kAlignmentDrift = 0.3;
// A good receiver's heading may be this far off for long (SAE J2945/1 asks for 2 degrees).
constexpr double kHonestHeading_rad = FromDegrees(2.0);

// What limits grow by: everywhere, and along the track beside.
struct Slack {
  double all_m = 0.0;
  double along_m = 0.0;
};

// How far a residual exceeds limits that are looser along track: 1 = at the limit.
double Excess(const Eigen::Vector2d& residual_O, const CoObservation& now, double limit_m,
              const Slack& slack) {
  const double c = std::cos(now.track_yaw_rad);
  const double s = std::sin(now.track_yaw_rad);
  const double along_m = c * residual_O.x() + s * residual_O.y();
  const double across_m = -s * residual_O.x() + c * residual_O.y();
  const double across_limit_m = limit_m + slack.all_m;
  return std::hypot(along_m / (across_limit_m + slack.along_m), across_m / across_limit_m);
}

std::optional<Finding> JudgeResidual(Check check, const Eigen::Vector2d& residual_O,
                                     const CoObservation& now, double withdraw_m, double accuse_m,
                                     const Slack& slack) {
  if (Excess(residual_O, now, accuse_m, slack) > 1.0) {
    return Finding{check, Verdict::kAccuse, "residual_m", residual_O.norm(), accuse_m};
  }
  if (Excess(residual_O, now, withdraw_m, slack) > 1.0) {
    return Finding{check, Verdict::kWithdraw, "residual_m", residual_O.norm(), withdraw_m};
  }
  return std::nullopt;
}

}  // namespace

void ResidualHistory::LookForTear(const CoObservation& observation, const TrustConfig& config) {
  const double dt_s = last_step_ ? std::max(0.0, ToSeconds(observation.stamp - *last_step_)) : 0.0;
  // However little the sensors know, a track that strays so far is no longer the sender's.
  const double limit_m = config.torn_m + std::min(2.0 * observation.sensed_sigma_m, config.torn_m) +
                         kJitter_s * std::abs(observation.track_speed_mps);
  if (last_step_ && dt_s <= 1.0) {
    Eigen::Vector2d step = observation.residual_O - last_residual_;
    if (observation.velocity_residual_O) step -= dt_s * *observation.velocity_residual_O;
    unexplained_ = std::exp(-dt_s / config.mean_time_s) * unexplained_ + step;
    torn_m_ = unexplained_.norm();
    is_torn_ = torn_m_ > limit_m;
  } else {
    // After a time unseen the vehicle has come back, or another has been taken for it.
    torn_m_ = (observation.residual_O - mean_).norm();
    is_torn_ = has_any_ && torn_m_ > limit_m;
    unexplained_.setZero();
  }
  // During a partial observation the mean is kept: the part may be off by up to a vehicle's size.
  if (observation.is_partial && has_any_ && !is_torn_) {
    torn_m_ = (observation.residual_O - mean_).norm();
    is_torn_ = torn_m_ > limit_m + config.torn_m;
  }
  last_step_ = observation.stamp;
  last_residual_ = observation.residual_O;
}

void ResidualHistory::Add(const CoObservation& observation, const TrustConfig& config) {
  LookForTear(observation, config);
  if (observation.is_partial) return;
  const double dt_s = has_any_ ? std::max(0.0, ToSeconds(observation.stamp - last_)) : 0.0;
  // A plain mean at first, so that one wild first residual does not linger; fading afterwards.
  const auto weight = [&](double time_s, double memory_s) {
    const double span_s = std::max(std::min(time_s, memory_s), 1e-3);
    return has_any_ ? 1.0 - std::exp(-std::max(dt_s, 1e-3) / span_s) : 1.0;
  };
  const double w = weight(time_s_ + dt_s, config.mean_time_s);
  if (dt_s <= 1.0) time_s_ += dt_s;
  mean_ += w * (observation.residual_O - mean_);
  const double w_fast = weight(time_s_, kFastShare * config.mean_time_s);
  sensed_sigma_ += w * (observation.sensed_sigma_m - sensed_sigma_);
  // What was not known of the length at the start of a drift counts until its end.
  const double w_slow = has_any_ ? 1.0 - std::exp(-dt_s / (10.0 * config.mean_time_s)) : 1.0;
  extent_sigma_ += w_slow * (observation.extent_sigma_m - extent_sigma_);
  fast_mean_ += w_fast * (observation.residual_O - fast_mean_);
  speed_ += w * (observation.speed_residual_mps - speed_);
  speed_sigma_ += w * (observation.speed_sigma_mps - speed_sigma_);
  const double w_long = weight(time_s_, 3.0 * config.mean_time_s);
  accel_ += w_long * (observation.accel_residual_mps2 - accel_);
  accel_sigma_ += w_long * (observation.accel_sigma_mps2 - accel_sigma_);
  if (observation.yaw_residual_rad) {
    const double w_yaw = has_yaw_ ? w : 1.0;
    yaw_ += w_yaw * (*observation.yaw_residual_rad - yaw_);
    yaw_sigma_ += w_yaw * (observation.yaw_sigma_rad - yaw_sigma_);
    has_yaw_ = true;
  }
  if (observation.velocity_residual_O && dt_s <= 1.0) {
    walked_ += dt_s * *observation.velocity_residual_O;
  }
  if (!has_any_) block_start_ = observation.stamp;
  if (ToSeconds(observation.stamp - block_start_) >= 1.0 && block_size_ > 0) {
    blocks_[block_count_++ % kBlocks] = block_sum_ / block_size_;
    block_sum_.setZero();
    block_size_ = 0;
    block_start_ = observation.stamp;
  }
  block_sum_ +=
      (Block() << observation.residual_O, observation.track_speed_mps, walked_).finished();
  ++block_size_;
  has_any_ = true;
  last_ = observation.stamp;
}

void ResidualHistory::Restart() {
  has_any_ = false;
  has_yaw_ = false;
  time_s_ = 0.0;
  block_count_ = 0;
  block_sum_.setZero();
  block_size_ = 0;
}

std::optional<Eigen::Vector2d> ResidualHistory::reference_O() const {
  if (block_count_ < 2) return std::nullopt;
  return Reference().head<2>();
}

double ResidualHistory::reference_speed_mps() const {
  return block_count_ < 2 ? 0.0 : Reference().z();
}

std::optional<Eigen::Vector2d> ResidualHistory::walked_O() const {
  if (block_count_ < 2) return std::nullopt;
  return walked_ - Reference().tail<2>();
}

ResidualHistory::Block ResidualHistory::Reference() const {
  const std::uint64_t oldest = block_count_ > kBlocks ? block_count_ - kBlocks : 0;
  return 0.5 * (blocks_[oldest % kBlocks] + blocks_[(oldest + 1) % kBlocks]);
}

bool IsFarApart(const CoObservation& now, const TrustConfig& config) {
  const Eigen::Vector2d shift_O = now.is_ego_shifted ? now.shift_O : Eigen::Vector2d::Zero();
  return Excess(now.residual_O - shift_O, now, config.level_withdraw_m,
                {now.alignment_sigma_m, config.stale_position_s * std::abs(now.track_speed_mps)}) >
         1.0;
}

std::optional<Finding> CheckLevel(const ResidualHistory& history, const CoObservation& now,
                                  const TrustConfig& config) {
  if (!history.is_settled()) return std::nullopt;
  // A shift of all senders may be our own fault. A sender without that shift is not penalised for
  // it: the shift may be a lie that several senders report together.
  Eigen::Vector2d own_O = history.mean_O();
  if (now.is_ego_shifted && (own_O - now.shift_O).norm() < own_O.norm()) own_O -= now.shift_O;
  return JudgeResidual(
      Check::kResidualLevel, own_O, now, config.level_withdraw_m, config.level_accuse_m,
      {now.alignment_sigma_m + 2.0 * history.sensed_sigma_m(),
       config.stale_position_s * std::abs(now.track_speed_mps) + 2.0 * history.extent_sigma_m()});
}

std::optional<Finding> CheckDrift(const ResidualHistory& history, const CoObservation& now,
                                  const TrustConfig& config) {
  const auto reference_O = history.reference_O();
  if (!reference_O || now.is_ego_shifted) return std::nullopt;
  const double changed_mps = std::abs(now.track_speed_mps - history.reference_speed_mps());
  return JudgeResidual(
      Check::kResidualDrift, history.mean_O() - *reference_O, now, config.drift_withdraw_m,
      config.drift_accuse_m,
      {kAlignmentDrift * now.alignment_sigma_m + 2.0 * history.sensed_sigma_m(),
       config.stale_position_s * changed_mps + kJitter_s * std::abs(now.track_speed_mps) +
           2.0 * history.extent_sigma_m()});
}

std::optional<Finding> CheckVelocity(const ResidualHistory& history, const CoObservation& now,
                                     const TrustConfig& config) {
  if (!history.is_settled()) return std::nullopt;
  // Both components of the velocity: a car that slides sideways out of its lane keeps its speed.
  const double track_mps = std::abs(now.track_speed_mps);
  const double along_mps = history.speed_mps();
  const double along_slack_mps = 2.0 * history.speed_sigma_mps();
  const double across_mps = history.has_yaw() ? track_mps * std::sin(history.yaw_rad()) : 0.0;
  const double across_slack_mps = track_mps * (2.0 * history.yaw_sigma_rad() + kHonestHeading_rad);
  const auto exceeds = [&](double limit_mps) {
    return std::hypot(along_mps / (limit_mps + along_slack_mps),
                      across_mps / (limit_mps + across_slack_mps)) > 1.0;
  };
  const double residual_mps = std::hypot(along_mps, across_mps);
  const Eigen::Vector2d rate_O = history.rate_O(config);
  const double c = std::cos(now.track_yaw_rad);
  const double s = std::sin(now.track_yaw_rad);
  const double moved_mps = ((c * rate_O.x() + s * rate_O.y()) * along_mps +
                            (-s * rate_O.x() + c * rate_O.y()) * across_mps) /
                           std::max(residual_mps, 1e-6);
  const auto reference_O = history.reference_O();
  if (!reference_O || (history.fast_mean_O() - *reference_O).norm() < config.leaving_m ||
      moved_mps < kConfirmedShare * residual_mps) {
    return std::nullopt;
  }
  if (exceeds(config.speed_accuse_mps)) {
    return Finding{Check::kVelocityResidual, Verdict::kAccuse, "velocity_residual_mps",
                   residual_mps, config.speed_accuse_mps};
  }
  if (exceeds(config.speed_withdraw_mps)) {
    return Finding{Check::kVelocityResidual, Verdict::kWithdraw, "velocity_residual_mps",
                   residual_mps, config.speed_withdraw_mps};
  }
  if (!history.has_yaw() || std::abs(now.track_speed_mps) < config.heading_min_speed_mps) {
    return std::nullopt;
  }
  const double yaw_rad = std::abs(history.yaw_rad());
  const double slack_rad = 2.0 * history.yaw_sigma_rad();
  if (yaw_rad > config.heading_accuse_rad + slack_rad) {
    return Finding{Check::kHeadingResidual, Verdict::kAccuse, "heading_residual_rad", yaw_rad,
                   config.heading_accuse_rad + slack_rad};
  }
  if (yaw_rad > config.heading_withdraw_rad + slack_rad) {
    return Finding{Check::kHeadingResidual, Verdict::kWithdraw, "heading_residual_rad", yaw_rad,
                   config.heading_withdraw_rad + slack_rad};
  }
  return std::nullopt;
}

std::optional<Finding> CheckAcceleration(const ResidualHistory& history, const CoObservation&,
                                         const TrustConfig& config) {
  if (history.time_s() < 3.0 * config.mean_time_s) return std::nullopt;
  const double limit_mps2 = config.accel_withdraw_mps2 + 2.0 * history.accel_sigma_mps2();
  if (std::abs(history.accel_mps2()) <= limit_mps2) return std::nullopt;
  return Finding{Check::kAccelerationResidual, Verdict::kWithdraw, "acceleration_residual_mps2",
                 history.accel_mps2(), limit_mps2};
}

bool IsWalkingOff(const ResidualHistory& history, const TrustConfig& config) {
  const auto reference_O = history.reference_O();
  const auto walked_O = history.walked_O();
  if (!reference_O || !walked_O) return false;
  const Eigen::Vector2d moved_O = history.fast_mean_O() - *reference_O;
  const double walked_m = walked_O->norm();
  const double limit_m = config.leaving_m + 2.0 * history.sensed_sigma_m();
  if (walked_m <= limit_m || moved_O.dot(*walked_O) <= limit_m * walked_m) return false;
  return (moved_O - *walked_O).norm() <= kConfirmedShare * moved_O.norm();
}

bool IsSizePlausible(const std::optional<double>& length_m, const std::optional<double>& width_m,
                     const Extent& sensed, const TrustConfig& config) {
  const auto fits = [&](const std::optional<double>& claimed_m, double sensed_m, double sigma_m) {
    return !claimed_m ||
           std::abs(*claimed_m - sensed_m) <= config.size_mismatch * sensed_m + 2.0 * sigma_m;
  };
  return fits(length_m, sensed.length_m, sensed.length_sigma_m) &&
         fits(width_m, sensed.width_m, sensed.width_sigma_m);
}

}  // namespace v2vouch
