// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "daemon/common/base/time.h"
#include "daemon/local/odometry/standing_world.h"

namespace v2vouch {

/// Yaw rate against the Doppler of the standing world. A radar ahead of the rear axle moves
/// sideways in a turn; where the yaw rate is wrong by dw, the speed that a return votes for is off
/// by dw t, t = x tan a - y. Votes with |t| > 2.5 m are counted for each dw of a grid, fading
/// within a second; one that both sides (signs of t) support and that has 1.4 times the votes of dw
/// = 0 for kHold_s makes the yaw rate suspect. Reported only: nothing is corrected. Copyable, fixed
/// size.
class YawCheck {
 public:
  /// `world` as read with the yaw rate in use; `speed_mps` is the one in use.
  void OnScan(Timestamp stamp, const StandingWorld& world, double speed_mps);

  [[nodiscard]] bool is_suspect() const { return is_suspect_; }
  /// What the yaw rate in use lacks [rad/s].
  [[nodiscard]] double missing_radps() const { return missing_radps_; }

  static constexpr double kHold_s = 1.5;

 private:
  static constexpr int kHalf = 20;
  static constexpr double kStep_radps = 0.03;
  static constexpr std::size_t kCount = 2 * kHalf + 1;
  std::array<float, kCount> left_{};
  std::array<float, kCount> right_{};
  Timestamp last_{};
  Timestamp since_{};
  bool is_suspect_ = false;
  double missing_radps_ = 0.0;
};

}  // namespace v2vouch
