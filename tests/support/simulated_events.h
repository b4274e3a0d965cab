// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/simulation/simulation.h"

namespace v2vouch::testing {

/// A whole drive of the simulator, in order of arrival.
inline std::vector<sim::SimEvent> AllEvents(const sim::World& world, std::uint64_t seed) {
  sim::Simulation simulation(world, seed);
  std::vector<sim::SimEvent> all;
  std::vector<sim::SimEvent> events;
  for (bool more = true; more;) {
    more = simulation.Step(events);
    all.insert(all.end(), events.begin(), events.end());
  }
  return all;
}

}  // namespace v2vouch::testing
