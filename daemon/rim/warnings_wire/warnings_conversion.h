// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <v2vouch/ego_intent_t.hpp>
#include <v2vouch/ego_motion_t.hpp>
#include <v2vouch/track_list_t.hpp>
#include <v2vouch/warning_list_t.hpp>

#include "daemon/warnings/warning.h"

namespace v2vouch::wire {

enum class ListOrigin {
  kLocal,
  kPriority,
  kUnverified,  ///< TRACKS_V2V taken for true, for comparison: as if own sensors had seen it now.
};

/// Tracks that are not confirmed, or whose state or covariance is not finite, are left out (of
/// kUnverified only the latter).
warnings::TargetList ToTargets(const track_list_t& list, ListOrigin origin);

/// nullopt where time or speed cannot be.
std::optional<warnings::EgoReading> ToEgoReading(const ego_motion_t& motion);

/// What is unknown or cannot be is left at its default; a path with a point that is not finite, or
/// with fewer than two, is no path.
warnings::EgoIntent ToIntent(const ego_intent_t& intent);

warning_list_t ToMessage(const warnings::WarningList& list);

}  // namespace v2vouch::wire
