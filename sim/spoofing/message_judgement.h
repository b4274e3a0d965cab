// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {

/// When what a message says counts as false, against what an honest unit of the same vehicle with
/// the same receiver errors would have said.
struct Falseness {
  static constexpr double kPosition_m = 2.0;
  static constexpr double kSpeed_mps = 1.0;
  static constexpr double kHeading_rad = 0.2617993877991494;  ///< 15 degrees ...
  static constexpr double kHeadingFrom_mps = 3.0;             ///< ... while honestly faster.
  static constexpr double kAge_s = 1.0;     ///< Older, and what it says is no longer so:
  static constexpr double kSame_m = 0.5;    ///< within these an old message of a standing car
  static constexpr double kSame_mps = 0.5;  ///< is what an honest unit would say now.
};

/// One message of TRUTH_BSM, judged.
struct JudgedMessage {
  std::size_t truth = 0;  ///< Index into RunLog::bsm_truths.
  bool is_false = false;  ///< The position, the speed, the heading, the age, the vehicle or
                          ///< the identity is not the sender's own.
  /// The claimed place is in joint view (JointView); or the id is eligible and the vehicle it
  /// speaks for is: sensors that knew a car see that it has not gone where it says.
  bool is_in_view = false;
  bool is_eligible = false;    ///< The sender id's claims were in joint view long enough before.
  bool is_contested = false;   ///< Honest, but an attacker uses the same id at the time.
  bool is_positive = false;    ///< Refused as misbehaviour, or mistrusted.
  bool is_mistrusted = false;  ///< The sender is SUSPECT or REVOKED at use.
  bool has_verdict = false;    ///< The log says what became of it.
  bool is_relied_on = false;   ///< The sender is VALIDATED or BRIDGED.

  /// Counts in precision and recall: false ones of attackers, and all of honest devices whose id
  /// nobody else uses. True messages of attackers count neither way.
  [[nodiscard]] bool counts(const BsmTruth& truth_of_it) const {
    if (!is_in_view || !is_eligible || is_contested) return false;
    return truth_of_it.is_attacker ? is_false : true;
  }
};

/// How long the claims of an id must have been in joint view before its messages count: the time
/// in which validation is possible.
inline constexpr double kEligibleAfter_s = 2.0;

/// Whether a refusal says something against the message. The other kinds (the car does not know
/// where it is, its own echo, nothing usable inside) do not.
bool IsHardRefusal(std::string_view reason);

/// All messages of `log.bsm_truths` that are within the truth's time, in their order. A message
/// without verdict is neither positive nor relied on.
std::vector<JudgedMessage> JudgeMessages(const RunLog& log);

/// Who uses which id, from TRUTH_BSM.
class Senders {
 public:
  explicit Senders(const RunLog& log);

  /// Attackers' use of an id ends so long after its last attack message.
  static constexpr double kLinger_s = 10.0;

  struct Attack {
    Timestamp first{};
    std::int64_t device = 0;
    std::int64_t original_vehicle = 0;  ///< The first that device spoke for; 0 = none.
  };
  /// The attack under this id: the newest begun by `t`; null before, or for honest ids.
  [[nodiscard]] const Attack* AttackUnder(std::uint32_t sender, Timestamp t) const;
  /// The attacker to whom a verdict about `sender` at `t` belongs: the id's attack has begun, and
  /// no honest device uses the id too or the attack went on within `kLinger_s` before.
  [[nodiscard]] std::optional<std::int64_t> AttackerMeant(std::uint32_t sender, Timestamp t) const;
  /// An honest device that uses the id, if any.
  [[nodiscard]] std::optional<std::int64_t> HonestUser(std::uint32_t sender) const;
  /// The device belongs to an attacker.
  [[nodiscard]] bool IsAttacker(std::int64_t device) const;
  /// An attack message under this id is within `seconds` of `t`.
  [[nodiscard]] bool IsUnderAttack(std::uint32_t sender, Timestamp t, double seconds) const;

 private:
  struct Use {
    std::vector<Attack> attacks;             // One per device, in order of time.
    std::vector<Timestamp> attack_messages;  // Rising.
    std::optional<std::int64_t> honest_device;
  };
  std::map<std::uint32_t, Use> uses_;
  std::map<std::int64_t, bool> is_attacker_;
};

}  // namespace v2vouch::evaluation
