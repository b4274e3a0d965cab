// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>

#include "daemon/common/data/finding.h"
#include "daemon/v2v/intake/message_check_config.h"

namespace v2vouch {

/// From one claim of a sender to its next.
struct PathStep {
  double dt_s = 0.0;  ///< Between the claimed times of the two contents, > 0.
  Eigen::Vector2d moved_m = Eigen::Vector2d::Zero();    ///< Between the places, east-north.
  Eigen::Vector2d claimed_m = Eigen::Vector2d::Zero();  ///< Way that the claimed motion would make.
  double sigma_m = 1.5;  ///< Assumed accuracy; bounds how much scatter is accepted as noise.
};

/// The way of a vehicle that goes from one velocity to another in `dt_s`: the chord of the arc
/// between both directions at the mean speed. Directions and signed speeds along them.
Eigen::Vector2d ClaimedWay(double yaw_from_rad, double speed_from_mps, double yaw_to_rad,
                           double speed_to_mps, double dt_s);

/// speed_against_path and course_against_path: claimed speed and course against the sender's own
/// displacement.
///
/// What the places have moved beyond the claimed way, r(t), is regressed on time over windows of
/// 1 to 5 s in which either way is 10 m long:
///
///     b = slope of r,  V_c = claimed way / T,  V_p = V_c + b  (velocity made good)
///     speed_against_path:   ||V_p| - |V_c|| > path_speed_mps + share |V_c| + k sigma_b
///     course_against_path:  angle(V_p, V_c) > path_course + k sigma_b / |V_p|,
///                           both faster than path_min_speed
///
/// sigma_b follows from the scatter about the line, at least 0.4 m + 0.02 s |V|; at most four
/// places a second count as independent. A single step in r (GNSS that re-converges) is no speed:
/// the line may break once, and both fits must exceed the limit. Twice the limit for accuse_hold_s
/// is an accusation; not so a direction turned round at walking pace, which an honest unit that
/// does not tell its gear shows in reverse.
///
/// Silences over 2 s start anew. Fixed size; a window costs a few sums per message.
class PathCheck {
 public:
  std::optional<Finding> Judge(const PathStep& step, const MessageCheckConfig& config);
  void Restart();

 private:
  static constexpr std::size_t kSteps = 64;
  struct Stored {
    float dt_s = 0.0F;
    float excess_x_m = 0.0F;  // moved - claimed.
    float excess_y_m = 0.0F;
    float claimed_x_m = 0.0F;
    float claimed_y_m = 0.0F;
  };

  std::array<Stored, kSteps> steps_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  double speed_held_s_ = 0.0;  // How long each has stood at twice its limit.
  double course_held_s_ = 0.0;
};

}  // namespace v2vouch
