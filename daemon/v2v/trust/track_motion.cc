// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/track_motion.h"

#include <algorithm>

namespace v2vouch {
namespace {

constexpr double kMostAccel_mps2 = 8.0;  // Emergency braking on dry asphalt.
constexpr double kNoise_mps = 1.5;       // Of a track's velocity.
constexpr double kSpan_s = 0.6;          // Velocities are compared over so long.
constexpr double kMemory_s = 3.0;        // So long residuals cause no blame.
constexpr double kSpacing_s = 0.07;      // The ring spans kSpan_s at any rate of messages.

}  // namespace

bool TrackMotion::Observe(Timestamp stamp, const Eigen::Vector2d& velocity_O) {
  const std::uint64_t kept = std::min<std::uint64_t>(count_, kSamples);
  bool is_broken = false;
  for (std::uint64_t i = 1; i <= kept; ++i) {
    const Sample& then = samples_[(count_ - i) % kSamples];
    const double dt_s = ToSeconds(stamp - then.stamp);
    if (dt_s < 0.0) return false;
    if (dt_s > kSpan_s) break;
    is_broken |= (velocity_O - then.velocity_O).norm() > kMostAccel_mps2 * dt_s + kNoise_mps;
  }
  if (is_broken) {
    broke_ = stamp;
    count_ = 0;  // What comes now is compared with itself.
  }
  if (count_ == 0 || ToSeconds(stamp - samples_[(count_ - 1) % kSamples].stamp) >= kSpacing_s) {
    samples_[count_++ % kSamples] = {stamp, velocity_O};
  }
  return is_broken;
}

bool TrackMotion::HasBroken(Timestamp now) const {
  return broke_ && ToSeconds(now - *broke_) <= kMemory_s;
}

}  // namespace v2vouch
