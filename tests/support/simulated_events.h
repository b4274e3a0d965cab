// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "sim/simulation/simulation.h"
#include "sim/world/scenario.h"
#include "sim/world/world.h"

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

/// The drive of a scenario written out as YAML; empty and a test failure when it cannot be run.
inline std::vector<sim::SimEvent> EventsOf(const std::string& yaml, std::uint64_t seed) {
  // Tests run side by side.
  const std::string path = ::testing::TempDir() + "/drive_" + std::to_string(getpid()) + ".yaml";
  std::ofstream(path) << yaml;
  sim::Scenario scenario;
  std::vector<std::string> problems;
  std::unique_ptr<sim::World> world;
  if (sim::LoadScenario(path, scenario, problems)) {
    world = sim::World::Make(scenario, seed, problems);
  }
  std::filesystem::remove(path);
  for (const std::string& problem : problems) ADD_FAILURE() << problem;
  return world ? AllEvents(*world, seed) : std::vector<sim::SimEvent>{};
}

}  // namespace v2vouch::testing
