// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "daemon/common/data/measurement.h"
#include "daemon/local/tracking/candidates.h"
#include "daemon/local/tracking/clutter_map.h"
#include "daemon/local/tracking/sensor_look.h"
#include "daemon/local/tracking/track_table.h"

namespace v2vouch {

/// Adds the clusters of one scan and sorts. A moving cluster may start a track, a stationary one
/// may not, nor may the second echo of a nearer cluster (is_echo). What is not finite is put where
/// no track is.
/// @param birth_per_m2_s density of new vehicles.
/// @param table whose CrowdOf the moving clusters is clutter, where it is more than the radar
/// promises: spread in range and azimuth as this scan shows.
/// @param clutter_map what clutter is at least, as earlier scans showed it.
void AddRadarCandidates(const RadarLook& look, std::span<const RadarMeasurement> measurements,
                        double birth_per_m2_s, const TrackTable& table,
                        const ClutterMap& clutter_map, Candidates& candidates);

/// Leaves the nearest of the measurements named, in their order. @return whether any had to go.
bool KeepNearest(std::span<const RadarMeasurement> measurements, std::size_t most,
                 std::vector<std::size_t>& which);

}  // namespace v2vouch
