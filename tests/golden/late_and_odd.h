// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/simulation/simulation.h"

namespace v2vouch::testing {

/// What a bad day's sensors make of a good drive of the shipped vehicle: pictures that come a
/// quarter of a second late, a radar with a wrong clock, copies, a counter that stands, unknown
/// sigmas and classes, an odometry that is silent for a while, and at 15 s a step of the common
/// clock by one hour.
std::vector<sim::SimEvent> LateAndOdd(const std::vector<sim::SimEvent>& drive);

}  // namespace v2vouch::testing
