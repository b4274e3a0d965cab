// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "daemon/common/data/claim.h"
#include "daemon/common/data/track.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/local/visibility/visibility.h"
#include "daemon/v2v/association/pair_evidence.h"
#include "daemon/v2v/perception/priority_config.h"
#include "daemon/v2v/trust/checks.h"

namespace v2vouch {

/// Positions are older than they say by so much and more, in some senders for good: a sigma of half
/// of what the trust checks allow (TrustConfig::stale_position_s).
inline constexpr double kStalePositionSigma_s = 0.075;

/// Whether a sensor has had the track so lately that it is there at `now`.
bool WasHitLately(const LocalTrack& track, Timestamp now);

/// Standard deviation of the position along the worse of the two axes of O [m].
double PositionSigma(const KinematicState& state);

/// A claim beside a LOCAL track that has been predicted to the claim's time. Both may describe the
/// same motion with opposite fronts (reversing, a stationary car of unknown direction): the reading
/// in which they agree better counts.
PairObservation Compare(const ClaimInOdometry& claim, const KinematicState& sensed);

/// The same for the trust checks: raw residuals, the sensors' own uncertainty beside them.
CoObservation ForTrust(const ClaimInOdometry& claim, const KinematicState& sensed);

/// Whether the sensors alone are sure enough of a track for PRIORITY: two kinds of them (radar,
/// camera, objects) where two or more cover the place, else the one that does, for long enough.
bool AreSensorsSure(const LocalTrack& track, const LocalFrame& frame, const VisibilityMap& map,
                    const VehicleConfig& vehicle, const SensorSupportConfig& config);

/// Whether the two footprints come within `slack_m` of each other, along and across the track.
bool AreClose(const Occluder& claimed, const LocalTrack& track, double slack_m);

/// Whose clear view of a place counts: any sensor's, or that of one of each kind that is mounted.
/// The map knows no wall that returns nothing; what two kinds call clear is clear.
enum class ClearTo : std::uint8_t { kAnySensor, kEveryKind };

/// How likely the sensors are to detect a vehicle on this footprint, where the place is in clear
/// view and the sector is watched; nullopt: not seeing it says nothing. A sector that
/// is degraded (a sensor of it is silent) counts for no more than the floor.
std::optional<double> ClearDetection(const Occluder& footprint, const LocalFrame& frame,
                                     const VisibilityMap& map, const VehicleConfig& vehicle,
                                     ClearTo whom, double least_detection);

}  // namespace v2vouch
