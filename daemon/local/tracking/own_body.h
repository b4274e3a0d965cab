// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "daemon/common/data/measurement.h"
#include "daemon/common/data/track.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/local/tracking/association.h"
#include "daemon/local/tracking/sensor_look.h"
#include "daemon/local/tracking/track_evidence.h"
#include "daemon/local/tracking/track_table.h"

// Tracks of radar alone that are no vehicle: a part of the ego itself (water on a radome, a tow
// bar, a bicycle rack), or something that a camera sees another vehicle through. Their evidence is
// counted here, and what follows from it said.
namespace v2vouch {

/// A reflection at `p_O` [m] that the track was given: at the ego's own body, which is nearer than
/// 2 m to an antenna or in the car's path within 2.5 m of its body, or apart from it. What has been
/// elsewhere once is no part of the car.
void NoteOwnBody(const VehicleConfig& vehicle, const RadarLook& look, const Eigen::Vector2d& p_O,
                 TrackEvidence& evidence);

/// Only ever reflected at the ego's own body, and no camera or source of objects has named it.
bool MayBeOwnBody(const LocalTrack& track, const TrackEvidence& evidence);

/// One picture, once it is associated: counts for each track of radar alone whether it shows a
/// listed vehicle at least 5 m behind it, in the middle of its near face.
void CountSeenThrough(const CameraLook& look, std::span<const CameraMeasurement> measurements,
                      const Association& association, TrackTable& table);

/// Seen through in three pictures (more than not), and in none itself.
bool IsTransparent(const LocalTrack& track, const TrackEvidence& evidence);

}  // namespace v2vouch
