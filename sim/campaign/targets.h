// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/campaign/summary.h"

namespace v2vouch::campaign {

/// One target of spoof resistance and what a campaign measured.
struct Target {
  std::string what;
  bool is_at_least = false;  ///< Of `limit`; otherwise at most.
  double limit = 0.0;
  std::optional<double> value;  ///< Worst over the variants it covers; nothing = not measured.
  bool is_censored = false;     ///< A time that never ended.
  std::string worst;            ///< The variant `value` belongs to.
  int digits = 2;

  [[nodiscard]] bool is_met() const {
    if (is_censored || !value) return false;
    return is_at_least ? *value >= limit : *value <= limit;
  }
  [[nodiscard]] std::string LimitText() const;
  [[nodiscard]] std::string ValueText() const;
};

/// All targets that the attacks and conditions of `summary` touch, in a fixed order.
std::vector<Target> JudgeTargets(const Summary& summary);

}  // namespace v2vouch::campaign
