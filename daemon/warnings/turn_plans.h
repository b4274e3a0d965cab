// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/warnings/prediction.h"
#include "daemon/warnings/warning.h"
#include "daemon/warnings/warnings_config.h"

namespace v2vouch::warnings {

/// What the ego is about, as far as it tells of a turn.
struct TurnState {
  bool stands = false;
  bool is_slow = false;     ///< Slow enough to turn off.
  bool turns_left = false;  ///< Begun, by its yaw rate.
  TurnSignal signal = TurnSignal::kUnknown;
};

/// Left turns that the driver may be about to take: the one begun, and after the signal the usual
/// one of this speed (radii of Euro NCAP's CCFtap), now or soon.
std::vector<EgoPlan> PlanTurns(const EgoPlan& plan, const TurnState& state,
                               const WarningsConfig& config);

}  // namespace v2vouch::warnings
