// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include "daemon/common/base/random.h"
#include "sim/attacks/claimed_path.h"
#include "sim/attacks/gate.h"

namespace v2vouch::sim {

/// What has been sent honestly so far, by vehicle, in order of time.
using Heard = std::map<std::uint32_t, std::deque<Message>>;

/// Whose messages a block changes.
struct Speaker {
  std::uint32_t device = 0;
  int first_identity = 0;  ///< Numbers of new identities count up from here.
  const Heard* heard = nullptr;
};

/// One block of `change` at work on one voice's messages, which pass it in order of time
/// (attack_change_spec.h says what each block does). It marks those it alters as `is_attack`.
class Change {
 public:
  Change(const ChangeSpec& spec, const AttackScene& scene, const Speaker& speaker,
         const Random& random);

  /// A message of the attack passes: changed, where the block's own gate is open.
  void Pass(const Circumstances& now, Message& message);
  /// A message passes while the attack rests.
  void Watch(const Message& message);
  /// How many messages are sent for one.
  int Times(const Circumstances& now);

  [[nodiscard]] const ChangeSpec& spec() const { return spec_; }

 private:
  // Place and motion (change_motion.cc).
  void Alter(const OffsetSpec& spec, const Moment& now, Message& message);
  void Alter(const DriftSpec& spec, const Moment& now, Message& message);
  void Alter(const BrakeSpec& spec, const Moment& now, Message& message);
  void Alter(const FreezeSpec& spec, const Moment& now, Message& message);
  void Alter(const EventualStopSpec& spec, const Moment& now, Message& message);
  void Alter(const MirrorSpec& spec, const Moment& now, Message& message);
  void Alter(const RotateSpec& spec, const Moment& now, Message& message);
  // Other claims (change_claims.cc).
  void Alter(const SpeedChangeSpec& spec, const Moment& now, Message& message);
  void Alter(const HeadingChangeSpec& spec, const Moment& now, Message& message);
  void Alter(const AccelerationChangeSpec& spec, const Moment& now, Message& message);
  void Alter(const SizeChangeSpec& spec, const Moment& now, Message& message);
  void Alter(const AccuracySpec& spec, const Moment& now, Message& message);
  // Time and identity (change_origin.cc).
  void Alter(const DelaySpec& spec, const Moment& now, Message& message);
  void Alter(const ReplaySpec& spec, const Moment& now, Message& message);
  void Alter(const IdentityChangeSpec& spec, const Moment& now, Message& message);
  void Alter(const ImpersonateSpec& spec, const Moment& now, Message& message);
  void Alter(const RateSpec&, const Moment&, Message&) {}

  void Remember(const Message& message);
  /// What passed `age_s` before `time_s`; reckoned back where nothing is so old.
  [[nodiscard]] Message PastAt(double time_s, double age_s) const;
  void ReplayVictim(const ReplaySpec& spec, const Moment& now, Message& message);
  /// Whether a value is to be drawn now; notes that it has been.
  bool IsToBeDrawn(Draw draw);

  ChangeSpec spec_;
  const AttackScene& scene_;
  Speaker speaker_;
  Random random_;
  Gate gate_;
  bool has_drawn_ = false;
  bool acts_ = true;  ///< On the message now passing.
  Vec2 drawn_place_ = Vec2::Zero();
  double drawn_ = 0.0;
  Statement first_;  ///< Said at the block's beginning, or when it stopped.
  bool has_stopped_ = false;
  std::deque<Message> past_;
  std::uint32_t victim_ = 0;  ///< Of a replay now ...
  int left_ = 0;              ///< ... how many more of its messages ...
  double replayed_s_ = 0.0;   ///< ... and when the last one replayed was sent.
  int count_ = -1;            ///< Of a new identity's messages.
};

}  // namespace v2vouch::sim
