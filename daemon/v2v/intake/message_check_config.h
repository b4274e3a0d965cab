// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"
#include "daemon/common/data/kinematic_limits.h"
#include "daemon/common/data/motion_continuity.h"

namespace v2vouch {

/// Limits of the checks that need nothing but a sender's own messages.
struct MessageCheckConfig {
  double late_s = 0.8;       ///< late_messages: median age of ten messages.
  double over_rate_s = 2.0;  ///< message_rate: over the sender's budget for so long.
  /// message_rate: more than this for a whole second is no accident.
  double accuse_rate_hz = 40.0;
  double own_motion_nis = 12.0;  ///< own_motion: mean NIS of ten messages (4 where consistent).
  double jump_m =
      kJump_m;  ///< position_jump: displacement that the claimed motion does not explain.
  /// position_jump: and never more than this times the time between.
  double jump_speed_mps = kMostRoadSpeed_mps;
  int accuse_jumps = 3;  ///< position_jump: of five messages.
  /// speed_against_path: claimed speed against the way made good: this ...
  double path_speed_mps = 0.8;
  double path_speed_share = 0.02;  ///< ... plus this share of the speed.
  /// course_against_path: claimed course against the way made good.
  double path_course_rad = FromDegrees(20.0);
  double path_min_speed_mps = 3.0;  ///< course_against_path: slower, courses are not judged.
  double path_min_m = 10.0;         ///< both: shorter ways are not judged.
  double path_noise_sigmas = 3.0;   ///< both: by how much noise may exceed the limits.
  double accuse_hold_s = 5.0;       ///< both: twice a limit for so long accuses.
  double max_accel_mps2 = kMostRoadAccel_mps2;  ///< implausible_motion: change of claimed speed.
  double size_change_m = 0.3;                   ///< size_change: within one identity ...
  double size_change_share = 0.1;  ///< ... or this share of the size, whichever is less.
  int implausible_messages = 3;    ///< implausible: refused as impossible, of ten.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("late_s", late_s, {.above = 0.1, .at_most = 10.0});
    a.Field("over_rate_s", over_rate_s, {.at_least = 0.5, .at_most = 60.0});
    a.Field("accuse_rate_hz", accuse_rate_hz, {.above = 1.0, .at_most = 1e5});
    a.Field("own_motion_nis", own_motion_nis, {.above = 4.0, .at_most = 1000.0});
    a.Field("jump_m", jump_m, {.above = 0.0, .at_most = 100.0});
    a.Field("jump_speed_mps", jump_speed_mps, {.above = 0.0, .at_most = 200.0});
    a.Field("accuse_jumps", accuse_jumps, {.at_least = 1, .at_most = 5});
    a.Field("path_speed_mps", path_speed_mps, {.above = 0.0, .at_most = 20.0});
    a.Field("path_speed_share", path_speed_share, {.at_least = 0.0, .at_most = 1.0});
    a.Degrees("path_course_deg", path_course_rad, {.above = 0.0, .at_most = 180.0});
    a.Field("path_min_speed_mps", path_min_speed_mps, {.at_least = 0.5, .at_most = 20.0});
    a.Field("path_min_m", path_min_m, {.above = 0.0, .at_most = 100.0});
    a.Field("path_noise_sigmas", path_noise_sigmas, {.at_least = 0.0, .at_most = 10.0});
    a.Field("accuse_hold_s", accuse_hold_s, {.at_least = 0.0, .at_most = 60.0});
    a.Field("max_accel_mps2", max_accel_mps2, {.above = 0.0, .at_most = 100.0});
    a.Field("size_change_m", size_change_m, {.above = 0.0, .at_most = 20.0});
    a.Field("size_change_share", size_change_share, {.above = 0.0, .at_most = 1.0});
    a.Field("implausible_messages", implausible_messages, {.at_least = 1, .at_most = 10});
  }
};

}  // namespace v2vouch
