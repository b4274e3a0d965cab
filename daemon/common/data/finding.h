// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "daemon/common/data/check.h"

namespace v2vouch {

/// WITHDRAW stops believing: cheap, fast, reversible. ACCUSE reports misbehaviour.
enum class Verdict : std::int8_t { kWithdraw = 1, kAccuse = 2 };

/// What one check found against a sender. `quantity` is a literal.
struct Finding {
  Check check{};
  Verdict severity = Verdict::kWithdraw;  ///< What this reading alone would justify.
  std::string_view quantity;              ///< With its unit.
  double value = 0.0;
  double limit = 0.0;  ///< Of `severity`.
};

}  // namespace v2vouch
