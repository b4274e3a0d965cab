// SPDX-License-Identifier: Apache-2.0
// Golden replay: six recorded inputs through the whole core, compared with the text beside this
// file. A difference is either a fault or a change that was meant; then scripts/golden writes the
// texts anew and their `git diff` is part of the commit.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/engine/engine.h"
#include "sim/import/comma2k19.h"
#include "sim/simulation/simulation.h"
#include "sim/world/overlay.h"
#include "sim/world/world.h"
#include "tests/golden/late_and_odd.h"
#include "tests/golden/list_text.h"
#include "tests/support/data_folder.h"
#include "tests/support/simulated_events.h"

namespace v2vouch::testing {
namespace {

constexpr double kLongest_s = 25.0;
constexpr int kMostDifferences = 12;

using Events = std::vector<sim::SimEvent>;

Events Simulate(const std::string& name, const std::string& overlay = "") {
  sim::Scenario scenario;
  std::vector<std::string> problems;
  std::unique_ptr<sim::World> world;
  if (sim::LoadScenario("sim/scenarios/" + name + ".yaml", scenario, problems)) {
    if (!overlay.empty()) {
      sim::LayOver("sim/attacks/catalogue/" + overlay + ".yaml", scenario, problems);
    }
    scenario.duration_s = std::min(scenario.duration_s, kLongest_s);
    if (sim::CheckReferences(scenario, problems)) world = sim::World::Make(scenario, 1, problems);
  }
  for (const std::string& problem : problems) ADD_FAILURE() << problem;
  return world ? AllEvents(*world, 1) : Events{};
}

std::string Perceive(const Events& events, const std::string& vehicle, const std::string& name) {
  DaemonConfig config;
  std::vector<std::string> problems;
  EXPECT_TRUE(LoadDaemonConfig(vehicle, config, problems));
  Engine engine(config);
  Outbox outbox;
  ListText text;
  for (const sim::SimEvent& event : events) {
    outbox.Clear();
    engine.OnMessage(event.channel, event.bytes, event.arrival, outbox);
    for (const Outbox::Message& message : outbox.messages()) text.Add(message);
  }
  text.AddRefusals(engine);
  // Not compared: the last bits may differ between processors. Between two builds on one machine
  // they tell whether a change kept every bit.
  std::printf("%s local %s priority %s\n", name.c_str(), engine.digest_local().c_str(),
              engine.digest_priority().c_str());
  return text.text();
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

void Compare(const std::string& name, const std::string& found) {
  const std::filesystem::path file = "tests/golden/expected/" + name + ".txt";
  if (std::getenv("V2VOUCH_WRITE_GOLDEN") != nullptr) {
    std::ofstream(file) << found;
    return;
  }
  std::ifstream stream(file);
  ASSERT_TRUE(stream) << "no " << file << ": scripts/golden writes it";
  std::stringstream content;
  content << stream.rdbuf();
  if (content.str() == found) return;
  const std::vector<std::string> was = Lines(content.str());
  const std::vector<std::string> is = Lines(found);
  std::string told;
  int differences = 0;
  for (std::size_t i = 0; i < std::max(was.size(), is.size()); ++i) {
    const std::string& a = i < was.size() ? was[i] : "(no line)";
    const std::string& b = i < is.size() ? is[i] : "(no line)";
    if (a == b || ++differences > kMostDifferences) continue;
    told += "line " + std::to_string(i + 1) + "\n  - " + a + "\n  + " + b + '\n';
  }
  ADD_FAILURE() << file << ": " << differences << " of " << was.size() << " lines differ\n"
                << told << "If this change is meant: scripts/golden, and look at git diff.";
}

void Check(const std::string& name, const Events& events,
           const std::string& vehicle = "daemon/vehicles/vehicle.yaml") {
  ASSERT_FALSE(events.empty());
  Compare(name, Perceive(events, vehicle, name));
}

TEST(Golden, LeftTurn) { Check("left_turn", Simulate("left_turn")); }
TEST(Golden, Urban) { Check("urban", Simulate("urban")); }
TEST(Golden, OcclusionWithALiar) {
  Check("occlusion_with_a_liar", Simulate("occlusion", "A07_lateral_0.5mps"));
}
TEST(Golden, Highway) { Check("highway", Simulate("highway")); }
TEST(Golden, LateAndOddData) { Check("late_and_odd", LateAndOdd(Simulate("left_turn"))); }

TEST(Golden, RealDrive) {
  const auto folder = DataFolder() / "radar" / "comma2k19_segment";
  if (!std::filesystem::exists(folder / "radar_tracks.csv")) {
    GTEST_SKIP() << "SKIPPED: no " << folder << " (set V2VOUCH_DATA)";
  }
  sim::Comma2k19Segment segment;
  std::string error;
  ASSERT_TRUE(sim::ReadComma2k19(folder.string(), segment, error)) << error;
  Events events;
  for (sim::ImportedEvent& event : sim::ToEvents(segment, {}, error)) {
    if (!events.empty() && event.received - events.front().arrival > FromSeconds(kLongest_s)) {
      break;
    }
    events.push_back({event.received, event.channel, std::move(event.bytes)});
  }
  Check("comma2k19", events, "daemon/vehicles/vehicle_comma2k19.yaml");
}

}  // namespace
}  // namespace v2vouch::testing
