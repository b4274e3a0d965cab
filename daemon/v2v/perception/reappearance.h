// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/v2v/perception/v2v_view.h"

namespace v2vouch {

/// Whether a LOCAL track is where the vehicle's sender says it is, its known bias taken off, and
/// moves as it says; where its last claim is old, as the bridge has carried it on. Another car that
/// comes into view near by is not it.
bool IsWhereClaimed(const V2vView& view, const LocalTrack& track, const PriorityVehicle& vehicle,
                    Timestamp stamp);

/// Whether the sensors have seen the hidden vehicle again within the last half second.
bool IsReappearing(const PriorityVehicle& vehicle, Timestamp stamp, const BridgeConfig& config);

/// A hidden vehicle comes back as its own LOCAL track, or as the nearest new one without a vehicle.
/// Counts hits; after BridgeConfig::regain_hits the vehicle is supported by that track again.
/// @return whether it has just become so.
bool UpdateReappearance(const V2vView& view, PriorityVehicle& vehicle, Timestamp stamp);

/// Check `seen_elsewhere`: a new track is where the sensors alone would have expected the hidden
/// vehicle, moves like it, and is not where the bridge has it. Counts hits.
std::optional<Finding> FindSeenElsewhere(const V2vView& view, PriorityVehicle& vehicle,
                                         Timestamp stamp);

}  // namespace v2vouch
