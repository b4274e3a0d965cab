// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "sim/import/fcd.h"

namespace v2vouch::sim {

/// Lets vehicles whose record ends go on, so that none of them vanishes within sight of the ego. A
/// traffic simulator removes vehicles at the edge of its net; real vehicles drive on.
///
/// From its last row on each goes straight ahead in steps of 0.1 s, at the speed it had (5 m/s at
/// least, reached with 1.5 m/s^2), and brakes for whatever drives or stands before it in a strip of
/// 4 m: speed at most (gap - 2 m) / 1.2 s. It ends `out_of_sight_m` from the ego, or at `to_s`.
/// Vehicles are continued in the order in which they left, so the one in front is there first.
///
/// @param bodies   one per motion.
/// @param ego      index; its own motion is left as it is.
void DriveOn(std::vector<std::vector<CentreSample>>& motions, const std::vector<FcdBody>& bodies,
             std::size_t ego, double to_s, double out_of_sight_m);

}  // namespace v2vouch::sim
