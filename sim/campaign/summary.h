// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/campaign/record.h"
#include "sim/spoofing/spoof_pool.h"
#include "sim/warnings/warn_tally.h"

namespace v2vouch::campaign {

/// Mean GOSPA over attacked runs and over the same runs without attack.
struct GospaUnderAttack {
  int runs = 0;
  double v2v_m = 0.0, v2v_plain_m = 0.0;
  double priority_m = 0.0, priority_plain_m = 0.0;
  double local_m = 0.0, local_plain_m = 0.0;

  /// Share of what the attack adds to V2V taken for true that it does not add to PRIORITY; nothing
  /// where it adds less than 0.1 m.
  [[nodiscard]] std::optional<double> averted() const;
};

/// Figures of all runs of one overlay, or of all variants of one id.
struct Group {
  std::string id;
  std::string variant;
  evaluation::AttackFigures attack;  ///< For conditions and plain runs, `attack.honest` counts.
  std::optional<evaluation::AttackFigures> paper;
  /// LOCAL digests of attacked runs against the same run without attack.
  int digests_compared = 0;
  int digests_changed = 0;
  /// Validated share over that of the same runs without attack; nothing without these.
  std::optional<double> validated_ratio;
  double step_max_us = 0.0;
  std::optional<GospaUnderAttack> gospa;  ///< Where there are runs without attack.
  std::optional<evaluation::WarnTally> warnings;
  std::vector<Group> variants;  ///< By name; of an id only.

  [[nodiscard]] std::string name() const { return variant.empty() ? id : id + "/" + variant; }
  /// Share of devices rightly accused or rightly not: attackers in joint view, honest ones heard.
  [[nodiscard]] std::optional<double> named_accuracy() const;
};

struct Summary {
  std::vector<Group> attacks;  ///< By id, in the catalogue's order.
  std::vector<Group> honest;   ///< By id.
  std::optional<Group> plain;
  evaluation::HonestTreatment all_honest;  ///< Over `honest`, or `plain` where that is empty.
  /// Vehicles that do not exist, A1 to A4 and A11: what was detected, at which false-positive rate.
  evaluation::Confusion phantom_messages, phantom_sources;
  std::optional<evaluation::WarnTally> attacked_warnings;  ///< Over `attacks`.
  std::optional<double> score;
  std::string weakest;  ///< Attack that sets the score.
  int runs = 0;
};

/// Pools records. A28 (a bias that honest receivers have too) must not be met, so it does not
/// count for the composite score.
Summary Summarise(const std::vector<RunRecord>& records);

/// {"attacks": [...], "honest": [...], "score": ...}; null where nothing could be measured. A time
/// that is null with `..._censored` true is that of an attacker never met.
std::string SummaryJson(const Summary& summary);

/// For the terminal; with `field`, the published methods beside ours.
std::string SummaryTable(const Summary& summary, bool field);

}  // namespace v2vouch::campaign
