// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <v2vouch/radar_detection_t.hpp>

#include "daemon/common/data/vehicle.h"
#include "sim/world/geometry.h"

namespace v2vouch::sim {

/// Whether a point at this range and azimuth, as seen from the antenna, is within range and field
/// of view.
bool Covers(const RadarConfig& radar, double range_m, double azimuth_rad);

/// A detection as the sensor reports it: its conventions (flips, range offset) applied backwards.
/// Strength and track are the caller's.
radar_detection_t Reported(const RadarConfig& radar, double range_m, double azimuth_rad,
                           double range_rate_mps);

/// Mirror image of `p` over the line through a and b.
Vec2 Mirrored(const Vec2& p, const Vec2& a, const Vec2& b);

}  // namespace v2vouch::sim
