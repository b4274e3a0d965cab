// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/spoofing/message_judgement.h"

namespace v2vouch::evaluation {

/// How the honest fare: what mistrust costs. Sums, so that runs add up.
struct HonestTreatment {
  static constexpr double kHeard_m = 150.0;  ///< Of the ego; the vehicle-hours count within.
  static constexpr double kDisc_m = 100.0;   ///< Validation and bridging count within.
  static constexpr double kBridgeFrom_s = 3.0;
  static constexpr double kBridgeTo_s = 6.0;
  static constexpr double kBridgeError_m = 2.0;

  /// Time in which honest devices were heard (silences above 2 s left out), by the vehicle's true
  /// place.
  double vehicle_s = 0.0;
  /// ... of it under SUSPECT or REVOKED, by the state at each message's use.
  double withdrawn_s = 0.0;
  int accusations = 0;  ///< ACCUSE verdicts on honest senders, one per sender, check and event.
  int withdrawals = 0;  ///< WITHDRAW likewise.
  int senders = 0;      ///< Honest devices heard.
  int accused = 0;      ///< ... with at least one ACCUSE.
  /// Messages of vehicles that a radar and a camera see, 5..100 m off, and have seen for
  /// kEligibleAfter_s without a break: the time in which validation is possible.
  int in_view = 0;
  int validated = 0;        ///< ... whose sender was VALIDATED or BRIDGED at use.
  double holdable_s = 0.0;  ///< Time honest V2V vehicles could be in PRIORITY (Bound).
  double held_s = 0.0;      ///< ... and were, matched within 10 m.
  /// Honest V2V vehicles hidden for 3..6 s on end (a glimpse below 0.5 s ends nothing), in PRIORITY
  /// within 2 m when it began, and within the disc all the time.
  int bridges = 0;
  int bridges_survived = 0;  ///< ... whose track stayed within 2 m throughout.
  int bridges_same_id = 0;   ///< ... and that have the same track a second after.
  /// Those that were over before the bridge's budget was, as it was published when they began. No
  /// other can survive but by a glimpse.
  int bridges_in_budget = 0;
  int survived_in_budget = 0;

  void Add(const HonestTreatment& other);
};

HonestTreatment JudgeHonest(const RunLog& log, const Senders& senders,
                            const std::vector<JudgedMessage>& judged);

}  // namespace v2vouch::evaluation
