// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/campaign/record.h"
#include "sim/spoofing/spoof_pool.h"

namespace v2vouch::campaign {

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
  std::vector<Group> variants;  ///< By name; of an id only.

  [[nodiscard]] std::string name() const { return variant.empty() ? id : id + "/" + variant; }
};

struct Summary {
  std::vector<Group> attacks;  ///< By id, in the catalogue's order.
  std::vector<Group> honest;   ///< By id.
  std::optional<Group> plain;
  evaluation::HonestTreatment all_honest;  ///< Over `honest`, or `plain` where that is empty.
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
