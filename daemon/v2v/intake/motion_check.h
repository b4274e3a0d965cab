// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "daemon/common/data/finding.h"
#include "daemon/v2v/intake/message_check_config.h"

namespace v2vouch {

/// own_motion: mean normalised innovation of the last ten messages against the sender's own motion.
///
///     own_motion, WITHDRAW: mean over ten of min(NIS 4 / dof / (1 + (dt / 0.25 s)^2), 40)
///                           > own_motion_nis
///
/// What brakes and steering do between two messages is not in the filter's noise where they are
/// few; hence the divisor. No two messages, however wild, reach the limit alone.
class InnovationCheck {
 public:
  /// @param nis of one message; nullopt where the motion was started anew for a silence.
  /// @param dt_s since the message before.
  std::optional<Finding> Judge(std::optional<double> nis, int freedom, double dt_s,
                               const MessageCheckConfig& config);

 private:
  std::array<float, 10> nis_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

/// Place and velocity of one claim in metres east-north of any point near by, at its claimed time.
struct PlaceAndVelocity {
  double time_s = 0.0;
  Eigen::Vector2d p_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d v_mps = Eigen::Vector2d::Zero();
};

/// position_jump: displacements that no motion explains.
///
///     unexplained = |p - (p_last + (v_last + v) / 2 dt)|
///     limit       = min(max(jump_m, jump_speed dt), jump_m + max_accel / 2 dt^2)
///     position_jump, WITHDRAW; ACCUSE where accuse_jumps of the last five messages jumped by 1.25
///       times the limit
///     two_places, WITHDRAW: the message goes on where the sender was before it last jumped: two
///       speak under one identity, and which of them lies is not known
class JumpCheck {
 public:
  std::optional<Finding> Judge(const PlaceAndVelocity& here, const MessageCheckConfig& config);

 private:
  std::optional<PlaceAndVelocity> last_;
  std::optional<PlaceAndVelocity> before_jump_;
  std::uint32_t jumps_ = 0;  // One bit per message, the newest lowest.
};

/// implausible_motion: claimed speed that changes faster than any vehicle's.
///
///     implausible_motion, WITHDRAW: two messages in a row differ from the two before them, in the
///     same direction, by more than max_accel dt + 2 m/s (noise and rounding)
///
/// One odd message is none.
class SpeedStepCheck {
 public:
  std::optional<Finding> Judge(double time_s, double speed_mps, const MessageCheckConfig& config);

 private:
  struct Said {
    double time_s = 0.0;
    double speed_mps = 0.0;
  };
  std::array<Said, 3> last_{};  // The newest first.
  int count_ = 0;
};

}  // namespace v2vouch
