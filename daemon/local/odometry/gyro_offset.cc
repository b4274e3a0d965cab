// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/odometry/gyro_offset.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

// One sample's noise. Three times that of common sensors: samples of one second are not independent
// (engine, door, passengers).
constexpr double kNoise_radps = FromDegrees(0.3);
// Growth of the offset's variance: 0.05 deg/s over ten minutes of warming up.
constexpr double kWalk_radps2 = FromDegrees(0.002) * FromDegrees(0.002);
constexpr double kSmooth_s = 0.3;
constexpr double kLongestStep_s = 0.5;

}  // namespace

double GyroOffset::sigma_radps() const { return std::sqrt(variance_); }

double GyroOffset::Read(Timestamp stamp, double yaw_rate_radps, Standstill standstill) {
  const double elapsed_s = last_ == Timestamp{} ? 0.0 : ToSeconds(stamp - last_);
  const double dt_s = std::clamp(elapsed_s, 0.0, kLongestStep_s);
  last_ = stamp;
  is_held_ = false;
  if (is_learnt()) {
    variance_ =
        std::min(variance_ + kWalk_radps2 * std::max(0.0, elapsed_s), kStart_radps * kStart_radps);
  }
  const double innovation = yaw_rate_radps - offset_;
  if (standstill == Standstill::kNo) {
    innovation_ = 0.0;
    beyond_s_ = 0.0;
    return innovation;
  }
  const double smooth = 1.0 - std::exp(-dt_s / kSmooth_s);
  innovation_ += smooth * (innovation - innovation_);
  const bool is_offset = std::abs(yaw_rate_radps) <= kMost_radps;
  if (!is_offset) {
    beyond_s_ = 0.0;
    return innovation;
  }
  const bool is_turn = is_learnt() && standstill != Standstill::kSeen &&
                       std::abs(innovation_) > kTurn_radps + 3.0 * sigma_radps();
  if (is_turn) {
    const bool is_steady = std::abs(innovation - innovation_) < kTurn_radps;
    beyond_s_ = is_steady ? beyond_s_ + dt_s : 0.0;
    if (beyond_s_ < kSteady_s) return innovation;
    variance_ = kStart_radps * kStart_radps;  // The offset has stepped: learn it anew.
    learnt_s_ = 0.0;
  }
  beyond_s_ = 0.0;
  const double gain = variance_ / (variance_ + kNoise_radps * kNoise_radps);
  offset_ = std::clamp(offset_ + gain * innovation, -kMost_radps, kMost_radps);
  variance_ *= 1.0 - gain;
  learnt_s_ += dt_s;
  is_held_ = true;
  return 0.0;
}

}  // namespace v2vouch
