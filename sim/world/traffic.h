// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sim/world/actor.h"
#include "sim/world/path.h"

namespace v2vouch::sim {

/// Draws the vehicles of `scenario.traffic` (traffic_spec.h) and appends them to `actors`, whose
/// members and the ego they keep clear of for `duration_s`.
/// @param ego motion of the centre of the ego's footprint.
/// @return false with a problem when the lanes have no room for all of them.
bool AddTraffic(const Scenario& scenario, const std::map<std::string, Path>& paths,
                const Trajectory& ego, double duration_s, std::uint64_t seed,
                std::vector<Actor>& actors, std::vector<std::string>& problems);

}  // namespace v2vouch::sim
