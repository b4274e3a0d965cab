// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/data/claim.h"
#include "daemon/v2v/intake/content_check.h"
#include "daemon/v2v/intake/motion_check.h"
#include "daemon/v2v/intake/path_check.h"
#include "daemon/v2v/intake/rate_check.h"

namespace v2vouch {

struct SenderTrack;

/// All checks that need nothing but one sender's own messages, with their memory. Fixed size
/// (under 2 kB), no allocation. What each finds stands with it.
///
/// A finding from refused messages (rate, implausible) is attached to the sender's next accepted
/// claim, as is a core heard under another id, within two seconds.
class SenderChecks {
 public:
  /// A message that is no repeat, before it is known whether it is taken.
  void OnHeard(Timestamp stamp) { rate_.OnMessage(stamp); }
  /// Refused for the sender's own budget.
  void OnOverRate(Timestamp stamp) { rate_.OnRefused(stamp); }
  /// Refused for what it claims.
  void OnImplausible() { implausible_.OnMessage(true); }
  /// The same core was heard under another id (contested_core). Which is the copy is not known:
  /// relays exist.
  void OnContested(Timestamp stamp) { contested_ = stamp; }
  /// What its heading means has turned out to be the other way (DirectionReading): ways and speeds
  /// of before were misread.
  void OnReread() {
    path_.Restart();
    last_path_.reset();
    speed_step_ = {};
  }

  /// Judges an accepted claim, already taken into `track`.
  /// @return the gravest finding; of equals the first of: contested_core, message_rate,
  ///   implausible, position_jump or two_places, implausible_motion, speed_against_path or
  ///   course_against_path, own_motion, size_change, late_messages. Places and ways of a sender
  ///   whose accuracy is poor are not judged.
  std::optional<Finding> Judge(const Claim& claim, const SenderTrack& track,
                               const MessageCheckConfig& config);

 private:
  std::optional<Finding> JudgeMotion(const Claim& claim, const SenderTrack& track,
                                     const MessageCheckConfig& config);

  RateCheck rate_;
  DelayCheck delay_;
  ImplausibleCheck implausible_;
  SizeCheck size_;
  InnovationCheck innovation_;
  JumpCheck jump_;
  SpeedStepCheck speed_step_;
  PathCheck path_;
  std::optional<Timestamp> contested_;
  std::optional<Timestamp> cleared_;  // The path, after a spell of poor accuracy.
  bool was_poor_ = false;             // The claim before.
  // The claim before, as judged for motion.
  struct Last {
    Timestamp received{};
    double claimed_s = 0.0;   // Its claimed time ...
    double credible_s = 0.0;  // ... and as far as it can be believed, since the first claim.
    Eigen::Vector3d p_E = Eigen::Vector3d::Zero();
    Eigen::Vector2d way_m = Eigen::Vector2d::Zero();  // East-north, since the first claim.
    double yaw_rad = 0.0;
    double speed_mps = 0.0;
    bool has_course = true;
  };
  std::optional<Last> last_;       // Of any claim ...
  std::optional<Last> last_path_;  // ... and of the last with a time of its own.
};

}  // namespace v2vouch
