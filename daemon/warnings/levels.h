// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/warnings/conflict.h"
#include "daemon/warnings/warning.h"
#include "daemon/warnings/warnings_config.h"

namespace v2vouch::warnings {

/// What bounds the level of a conflict beside its probability and time.
struct LevelBounds {
  double urgent_probability;  ///< Of contact: URGENT from here on.
  Level at_most = Level::kUrgent;
  Level by_gap = Level::kInfo;  ///< What the gap between the two alone comes to.
};

struct Levels {
  Level level = Level::kInfo;
  Level if_sure = Level::kInfo;  ///< The same with existence 1.
  Basis basis = Basis::kProbability;
};

/// The level that a conflict's probability and time come to: URGENT by the exact bodies, WARN and
/// ADVISE by the wider ones; of a vehicle that is not seen also by where it can be.
Levels LevelsOf(const Target& target, const Conflict& conflict, const Figures& figures,
                const LevelBounds& bounds, const WarningsConfig& config);

}  // namespace v2vouch::warnings
