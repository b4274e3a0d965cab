// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/attacks/radio_run.h"

#include <gtest/gtest.h>

#include "sim/attacks/attack_engine.h"
#include "sim/sensors/bsm.h"
#include "sim/world/overlay.h"

namespace v2vouch::sim {

std::vector<Received> RadioRun(const Scenario& scenario, std::uint64_t seed,
                               std::vector<std::string>* notes) {
  std::vector<std::string> problems;
  std::vector<Received> received;
  const auto world = World::Make(scenario, seed, problems);
  for (const std::string& problem : problems) ADD_FAILURE() << problem;
  if (!world) return received;
  std::vector<BsmSender> senders;
  for (std::size_t i = 0; i < world->actors().size(); ++i) {
    if (world->actors()[i].has_v2v) senders.emplace_back(*world, static_cast<int>(i), seed);
  }
  AttackEngine engine(*world, seed);
  if (notes != nullptr) *notes = engine.notes();
  const MessageWriter writer(scenario);
  for (double until = 1.0; until <= scenario.duration_s; until += 1.0) {
    std::vector<Message> messages;
    for (BsmSender& sender : senders) {
      while (sender.next_time_s() < until) {
        if (auto message = sender.NextMessage()) messages.push_back(*message);
      }
    }
    engine.Apply(until, messages);
    for (const Message& message : messages) {
      if (message.is_lost) continue;
      const bsm_t bsm = writer.Encode(message);
      received.push_back({bsm, writer.Truth(message, bsm), message});
    }
  }
  return received;
}

Scenario CampaignScenario(const std::string& name, const std::string& overlay) {
  Scenario scenario;
  std::vector<std::string> problems;
  LoadScenario("sim/scenarios/" + name + ".yaml", scenario, problems);
  scenario.traffic.vehicles = 6;
  if (!overlay.empty()) {
    LayOver("sim/attacks/catalogue/" + overlay + ".yaml", scenario, problems);
  }
  CheckReferences(scenario, problems);
  for (const std::string& problem : problems) ADD_FAILURE() << problem;
  return scenario;
}

}  // namespace v2vouch::sim
