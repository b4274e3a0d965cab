// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "sim/attacks/attack_engine.h"
#include "sim/attacks/view_timeline.h"
#include "sim/world/overlay.h"
#include "tests/sim/attacks/radio_run.h"

namespace v2vouch::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A scenario with an overlay given as text.
Scenario With(const std::string& yaml, std::vector<std::string>& problems) {
  Scenario scenario = CampaignScenario("campaign_urban", "");
  const auto path = std::filesystem::temp_directory_path() /
                    ("v2vouch_engine_" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(path) << "name: mine\n" << yaml;
  LayOver(path.string(), scenario, problems);
  std::filesystem::remove(path);
  return scenario;
}

TEST(AttackEngine, AFifthOfThoseWhoTalkLiesAndTheSameOnesEachTime) {
  const auto liars = [](std::uint64_t seed, std::size_t& talk) {
    std::set<std::int64_t> attackers, all;
    for (const auto& one : RadioRun(CampaignScenario("campaign_urban", "A05_lateral_8m"), seed)) {
      all.insert(one.truth.device_id);
      if (one.truth.is_attacker != 0) attackers.insert(one.truth.device_id);
    }
    talk = all.size();
    return attackers;
  };
  std::size_t talk = 0;
  const auto first = liars(11, talk);
  EXPECT_EQ(first.size(), static_cast<std::size_t>(std::lround(0.2 * static_cast<double>(talk))));
  EXPECT_EQ(first, liars(11, talk));
  EXPECT_NE(first, liars(12, talk));
}

TEST(AttackEngine, AttacksOnTheSameShareCompose) {
  std::vector<std::string> problems;
  const Scenario scenario = With(R"(
attacks:
  - {name: a, who: {share: 0.2}, when: {start_s: 5}, change: [{offset: {left_m: 8}}]}
  - {name: b, who: {share: 0.2}, when: {start_s: 10}, change: [{speed: {set_mps: 40}}]}
)",
                                 problems);
  ASSERT_TRUE(problems.empty()) << problems.front();
  std::set<std::string> names;
  for (const auto& one : RadioRun(scenario, 11)) {
    if (one.truth.is_attack == 0) continue;
    names.insert(one.truth.attack);
    EXPECT_EQ(one.truth.attack == "a+b", one.message.time_s >= 10.0);
    EXPECT_NEAR(std::hypot(one.truth.claimed_x_m - one.truth.honest_x_m,
                           one.truth.claimed_y_m - one.truth.honest_y_m),
                8.0, 0.02);
    if (one.truth.attack == "a+b") {
      EXPECT_EQ(one.truth.claimed_speed_mps, 40.0);
    }
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("a", "a+b"));
}

TEST(AttackEngine, AGhostKeepsItsDistanceOnTheEgosWay) {
  const Scenario scenario = CampaignScenario("campaign_urban", "A01_ahead_30m");
  std::vector<std::string> problems;
  const auto world = World::Make(scenario, 11, problems);
  int ghosts = 0;
  for (const auto& one : RadioRun(scenario, 11)) {
    if (one.truth.is_attack == 0) continue;
    ++ghosts;
    const EgoTruth ego = world->At(one.message.time_s).ego;
    const Vec2 centre = ego.PointAt(scenario.vehicle.centre_x_m, 0.0);
    EXPECT_NEAR(one.truth.claimed_x_m - centre.x(), 30.0, 0.05);  // The street is straight.
    EXPECT_NEAR(one.truth.claimed_speed_mps, ego.speed_mps, 0.02);
    EXPECT_EQ(one.truth.vehicle_id, 0);
    EXPECT_TRUE(std::isnan(one.truth.honest_x_m));
    EXPECT_GE(one.truth.device_id, static_cast<std::int64_t>(kFirstDeviceId));
  }
  EXPECT_GT(ghosts, 200);
}

TEST(AttackEngine, AWalkOffBeginsWhileItsVictimIsHidden) {
  const Scenario scenario = CampaignScenario("campaign_urban", "A14_2mps");
  std::vector<std::string> problems;
  const auto world = World::Make(scenario, 11, problems);
  const ViewTimeline views(*world, 11);
  double leaves_s = 0.0;
  std::int64_t victim = 0;
  for (const auto& one : RadioRun(scenario, 11)) {
    if (one.truth.is_attack == 0 || leaves_s > 0.0) continue;
    victim = one.truth.vehicle_id;
    const double aside = AngleDifference(one.truth.claimed_yaw_rad, one.truth.honest_yaw_rad);
    if (std::abs(aside) > 0.05) leaves_s = one.message.time_s;
  }
  ASSERT_GT(leaves_s, 0.0);
  const auto& actors = world->actors();
  const auto it =
      std::find_if(actors.begin(), actors.end(), [&](const Actor& a) { return a.id == victim; });
  ASSERT_NE(it, actors.end());
  EXPECT_FALSE(it->has_v2v);
  const auto index = static_cast<std::size_t>(it - actors.begin());
  EXPECT_NEAR(views.HiddenFor(index, leaves_s), 0.5, 0.25);
  EXPECT_GT(views.LastViewFor(index, leaves_s), 2.0);
  EXPECT_GT(views.LongestHidden(index), 1.5);
}

TEST(AttackEngine, VictimsOfSpoofingAreNoAttackersAndHonestOdditiesNoAttack) {
  for (const auto& one : RadioRun(CampaignScenario("campaign_urban", "A27_senders"), 11)) {
    EXPECT_EQ(one.truth.is_attacker, 0);
    EXPECT_EQ(one.truth.is_attack, one.message.time_s >= 15.0 ? 1 : 0);
  }
  std::map<std::int64_t, std::set<std::array<std::uint8_t, 4>>> ids;
  for (const auto& one : RadioRun(CampaignScenario("campaign_urban", "H05_hidden"), 11)) {
    EXPECT_EQ(one.truth.is_attacker + one.truth.is_attack, 0);
    ids[one.truth.device_id].insert(one.message.identity.id);
  }
  int changed = 0;
  for (const auto& [device, identities] : ids) changed += identities.size() == 2 ? 1 : 0;
  EXPECT_GE(changed, 1);  // Of the V2V cars that pass behind the lorry.
}

TEST(AttackEngine, AnImpersonatorBearsItsVictimsIdWhileThatGoesOn) {
  std::map<std::array<std::uint8_t, 4>, std::set<std::int64_t>> devices;
  for (const auto& one : RadioRun(CampaignScenario("campaign_urban", "A23_impersonate"), 11)) {
    if (one.message.time_s > 20.0) devices[one.message.identity.id].insert(one.truth.device_id);
  }
  int shared = 0;
  for (const auto& [id, who] : devices) shared += who.size() == 2 ? 1 : 0;
  EXPECT_EQ(shared, 1);
}

TEST(AttackEngine, AnAttackThatFindsNobodySaysSo) {
  std::vector<std::string> problems;
  const Scenario scenario =
      With("attacks: [{who: {devices: 1}, path: {shadow: {vehicle: 4711}}}]\n", problems);
  ASSERT_TRUE(problems.empty());
  std::vector<std::string> notes;
  RadioRun(scenario, 11, &notes);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("mine: no vehicle of the kind it needs")));
}

TEST(AttackSpec, MalformedOnesAreRefusedByName) {
  const auto problem_of = [](const std::string& attack) {
    std::vector<std::string> problems;
    With("attacks:\n  - " + attack + "\n", problems);
    EXPECT_EQ(problems.size(), 1u) << attack;
    return problems.empty() ? std::string() : problems.front();
  };
  const std::string who = "who: {share: 0.2}";
  EXPECT_THAT(problem_of("{change: [{offset: {left_m: 1}}]}"),
              HasSubstr("attacks[0].who: must give exactly one of"));
  EXPECT_THAT(problem_of("{" + who + "}"), HasSubstr("neither `path` nor `change`"));
  EXPECT_THAT(problem_of("{" + who + ", change: [{offset: {left_m: 1}, freeze: {speed: true}}]}"),
              HasSubstr("attacks[0].change[0]: must name exactly one block"));
  EXPECT_THAT(problem_of("{" + who + ", change: [{when: {after_s: 1}}]}"),
              HasSubstr("must name exactly one block"));
  EXPECT_THAT(problem_of("{" + who + ", change: [{ofset: {left_m: 1}}]}"),
              HasSubstr("attacks[0].change[0].ofset: unknown key (did you mean offset?)"));
  EXPECT_THAT(problem_of("{" + who + ", change: [{offset: {left_m: far}}]}"),
              HasSubstr("attacks[0].change[0].offset.left_m = far"));
  EXPECT_THAT(problem_of("{" + who + ", change: [{delay: {low_s: 3, high_s: 2}}]}"),
              HasSubstr("low_s, high_s: the first is above the second"));
  EXPECT_THAT(problem_of("{" + who + ", path: {ghost: {ahead_m: 3}, shadow: {count: 1}}}"),
              HasSubstr("attacks[0].path: must name one at most"));
  EXPECT_THAT(problem_of("{who: {devices: 1}, path: {swap: {within_m: 5}}}"),
              HasSubstr("needs a vehicle of the attacker's own"));
  EXPECT_THAT(problem_of("{" + who + ", path: {flood: {per_s: 10}}}"),
              HasSubstr("attacks[0].path.flood: is for devices"));
  EXPECT_THAT(problem_of("{who: {devices: 1}, when: {after_in_view_s: 2}, path: {ghost: {left_m: "
                         "1}}}"),
              HasSubstr("a device speaks for no vehicle"));
  EXPECT_THAT(problem_of("{" + who + ", when: {active_s: 2}, change: [{size: {swap: true}}]}"),
              HasSubstr("active_s and pause_s go together"));
}

TEST(AttackSpec, AttackersNamedMustTalk) {
  std::vector<std::string> problems;
  const Scenario scenario =
      With("attacks: [{who: {vehicles: [2, 3, 99]}, change: [{size: {swap: true}}]}]\n", problems);
  EXPECT_FALSE(CheckReferences(scenario, problems));
  EXPECT_THAT(problems, ElementsAre(HasSubstr("no vehicle 3 that talks"),
                                    HasSubstr("no vehicle 99 that talks")));
}

}  // namespace
}  // namespace v2vouch::sim
