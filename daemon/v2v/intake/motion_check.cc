// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/motion_check.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace v2vouch {
namespace {

constexpr double kFreedom = 4.0;    // Of a NIS with course; others are scaled to it.
constexpr double kMostNis = 40.0;   // One outlier of ten messages adds 4 to the mean.
constexpr double kUnseen_s = 0.25;  // From this gap on the motion between is unknown.
constexpr double kMemory_s = 2.0;   // A place left longer ago is left for good.
constexpr std::uint32_t kLastFive = 0b11111;
constexpr double kAccusingJump =
    1.25;  // Times the limit; raw fixes among high buildings jump, too.
constexpr double kStepNoise_mps = 2.0;
constexpr double kStepSpan_s = 1.0;  // Messages farther apart are not compared.

double Unexplained(const PlaceAndVelocity& from, const PlaceAndVelocity& to) {
  const double dt_s = to.time_s - from.time_s;
  return (to.p_m - from.p_m - 0.5 * dt_s * (from.v_mps + to.v_mps)).norm();
}

double Limit(double dt_s, const MessageCheckConfig& config) {
  return std::min(std::max(config.jump_m, config.jump_speed_mps * dt_s),
                  config.jump_m + 0.5 * config.max_accel_mps2 * dt_s * dt_s);
}

}  // namespace

std::optional<Finding> InnovationCheck::Judge(std::optional<double> nis, int freedom, double dt_s,
                                              const MessageCheckConfig& config) {
  if (!nis) return std::nullopt;
  const double unseen = dt_s / kUnseen_s;
  nis_[next_] =
      static_cast<float>(std::min(*nis * kFreedom / freedom / (1.0 + unseen * unseen), kMostNis));
  next_ = (next_ + 1) % nis_.size();
  count_ = std::min(count_ + 1, nis_.size());
  if (count_ < nis_.size()) return std::nullopt;
  double sum = 0.0;
  for (const float one : nis_) sum += one;
  const double mean = sum / static_cast<double>(nis_.size());
  if (mean <= config.own_motion_nis) return std::nullopt;
  return Finding{Check::kOwnMotion, Verdict::kWithdraw, "mean_nis", mean, config.own_motion_nis};
}

std::optional<Finding> JumpCheck::Judge(const PlaceAndVelocity& here,
                                        const MessageCheckConfig& config) {
  jumps_ = (jumps_ << 1U) & kLastFive;
  if (!last_) {
    last_ = here;
    return std::nullopt;
  }
  if (before_jump_ && here.time_s - before_jump_->time_s > kMemory_s) before_jump_.reset();
  // Stamps that go back or stand still say nothing about the way; the distance still does.
  PlaceAndVelocity now = here;
  now.time_s = std::max(here.time_s, last_->time_s);
  const double dt_s = now.time_s - last_->time_s;
  const double distance_m = Unexplained(*last_, now);
  const double limit_m = Limit(dt_s, config);
  if (distance_m <= limit_m) {
    last_ = now;
    return std::nullopt;
  }
  const bool is_back = before_jump_ && Unexplained(*before_jump_, now) <=
                                           0.5 * Limit(now.time_s - before_jump_->time_s, config);
  before_jump_ = *last_;
  last_ = now;
  if (is_back) {
    return Finding{Check::kTwoPlaces, Verdict::kWithdraw, "displacement_m", distance_m, limit_m};
  }
  if (distance_m > kAccusingJump * limit_m) jumps_ |= 1U;
  const bool accuses = std::popcount(jumps_) >= config.accuse_jumps;
  return Finding{Check::kPositionJump, accuses ? Verdict::kAccuse : Verdict::kWithdraw,
                 "displacement_m", distance_m, limit_m};
}

std::optional<Finding> SpeedStepCheck::Judge(double time_s, double speed_mps,
                                             const MessageCheckConfig& config) {
  const Said now{time_s, speed_mps};
  if (count_ > 0 && time_s <= last_[0].time_s) return std::nullopt;
  std::optional<Finding> finding;
  if (count_ == 3 && time_s - last_[1].time_s <= kStepSpan_s) {
    const Said& before = last_[1];
    const auto differ = [&](const Said& a, const Said& b) {
      return std::abs(b.speed_mps - a.speed_mps) >
             config.max_accel_mps2 * (b.time_s - a.time_s) + kStepNoise_mps;
    };
    const double first = last_[0].speed_mps - before.speed_mps;
    const double second = now.speed_mps - before.speed_mps;
    if (differ(before, last_[0]) && differ(before, now) && first * second > 0.0 &&
        !differ(last_[2], before)) {
      finding = Finding{Check::kImplausibleMotion, Verdict::kWithdraw, "acceleration_mps2",
                        first / (last_[0].time_s - before.time_s), config.max_accel_mps2};
    }
  }
  last_[2] = last_[1];
  last_[1] = last_[0];
  last_[0] = now;
  count_ = std::min(count_ + 1, 3);
  return finding;
}

}  // namespace v2vouch
