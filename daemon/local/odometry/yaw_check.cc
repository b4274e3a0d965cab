// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/odometry/yaw_check.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

constexpr double kFade_s = 1.0;
constexpr double kLeastLever_m = 2.5;
constexpr double kLeastSpeed_mps = 1.0;
constexpr double kGate_mps = 0.2;
constexpr double kLeastSide = 8.0;
constexpr int kLeastSteps = 2;  // 0.06 rad/s: less hides in mounting and lever arm.

}  // namespace

void YawCheck::OnScan(Timestamp stamp, const StandingWorld& world, double speed_mps) {
  const double dt_s = last_ == Timestamp{} ? 0.0 : std::clamp(ToSeconds(stamp - last_), 0.0, 5.0);
  last_ = stamp;
  const auto share = static_cast<float>(std::exp(-dt_s / kFade_s));
  for (std::size_t i = 0; i < kCount; ++i) {
    left_[i] *= share;
    right_[i] *= share;
  }
  if (std::abs(speed_mps) < kLeastSpeed_mps) {
    since_ = {};
    is_suspect_ = false;
    return;
  }
  for (const StandingWorld::Vote& vote : world.votes()) {
    if (std::abs(vote.lever_m) < kLeastLever_m) continue;
    const double off_mps = vote.speed_mps - speed_mps;
    const double gate_mps = std::max(kGate_mps, 2.0 * vote.sigma_mps);
    const double low = (off_mps - gate_mps) / vote.lever_m;
    const double high = (off_mps + gate_mps) / vote.lever_m;
    const double from = std::clamp(std::ceil(std::min(low, high) / kStep_radps), -1e3, 1e3);
    const double to = std::clamp(std::floor(std::max(low, high) / kStep_radps), -1e3, 1e3);
    auto& side = vote.lever_m > 0.0 ? left_ : right_;
    for (int k = std::max(-kHalf, static_cast<int>(from));
         k <= std::min(kHalf, static_cast<int>(to)); ++k) {
      side[static_cast<std::size_t>(k + kHalf)] += 1.0F;
    }
  }
  int best = 0;
  const auto both = [&](int k) {
    const auto i = static_cast<std::size_t>(k + kHalf);
    return left_[i] + right_[i];
  };
  for (int k = 1; k <= kHalf; ++k) {
    if (both(k) > both(best)) best = k;
    if (both(-k) > both(best)) best = -k;
  }
  const auto i = static_cast<std::size_t>(best + kHalf);
  const bool is_off = std::abs(best) >= kLeastSteps &&
                      std::min(left_[i], right_[i]) >= kLeastSide && both(best) > 1.4F * both(0);
  if (!is_off) {
    since_ = {};
    is_suspect_ = false;
    return;
  }
  if (since_ == Timestamp{}) since_ = stamp;
  missing_radps_ = kStep_radps * best;
  if (ToSeconds(stamp - since_) >= kHold_s) is_suspect_ = true;
}

}  // namespace v2vouch
