// SPDX-License-Identifier: Apache-2.0
#include "tests/calibration/extrinsics/simulated_drive.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "daemon/wire/input_decoder.h"
#include "sim/wire/simulation.h"
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
  ReasonCounts dropped{};
  sim::Simulation simulation(*world, seed);
  std::vector<sim::SimEvent> events;
  for (bool goes_on = true; goes_on;) {
    events.clear();
    goes_on = simulation.Step(events);
    for (const sim::SimEvent& event : events) {
      const auto channel = decoder.Find(event.channel);
      if (!channel) continue;
      const auto decoded = decoder.Decode(*channel, event.bytes, event.arrival, dropped);
      const Input* input = decoded ? std::get_if<Input>(&*decoded) : nullptr;
      if (input == nullptr) continue;
      if (const auto* scan = std::get_if<RadarScan>(input)) log.scans.push_back(*scan);
      if (const auto* boxes = std::get_if<CameraDetections>(input)) log.pictures.push_back(*boxes);
      if (const auto* motion = std::get_if<EgoMotion>(input)) log.motion.push_back(*motion);
      if (const auto* fix = std::get_if<GnssFix>(input)) log.fixes.push_back(*fix);
    }
  }
  const auto by_stamp = [](auto& messages) {
    std::ranges::stable_sort(messages, {}, [](const auto& m) { return m.stamp; });
  };
  by_stamp(log.motion);
  by_stamp(log.fixes);
  by_stamp(log.scans);
  by_stamp(log.pictures);
  return log;
}

}  // namespace v2vouch
