// SPDX-License-Identifier: Apache-2.0
#include "tests/calibration/extrinsics/simulated_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "daemon/rim/wire/input_decoder.h"
#include "sim/simulation/simulation.h"
#include "sim/world/world.h"

namespace v2vouch {

DriveLog SimulatedDrive(const std::string& name, double duration_s, std::uint64_t seed,
                        const std::function<void(sim::Scenario&)>& change) {
  DriveLog log;
  sim::Scenario scenario;
  std::vector<std::string> problems;
  sim::LoadScenario("sim/scenarios/" + name + ".yaml", scenario, problems);
  scenario.duration_s = std::min(scenario.duration_s, duration_s);
  if (change) change(scenario);
  const auto world = sim::World::Make(scenario, seed, problems);
  for (const std::string& problem : problems) ADD_FAILURE() << problem;
  if (world == nullptr) return log;
  const wire::InputDecoder decoder(VehicleConfig{}, wire::ChannelNames{});
  RefusalTally dropped;
  sim::Simulation simulation(*world, seed);
  std::vector<sim::SimEvent> events;
  for (bool goes_on = true; goes_on;) {
    events.clear();
    goes_on = simulation.Step(events);
    for (const sim::SimEvent& event : events) {
      const auto channel = decoder.Find(event.channel);
      if (!channel) continue;
      auto decoded = decoder.Decode(*channel, event.bytes, event.arrival, dropped);
      Input* const input = decoded ? std::get_if<Input>(&*decoded) : nullptr;
      if (input != nullptr) log.Keep(std::move(*input));
    }
  }
  log.SortByStamp();
  return log;
}

}  // namespace v2vouch
