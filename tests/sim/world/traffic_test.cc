// SPDX-License-Identifier: Apache-2.0
#include "sim/world/traffic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/world/overlay.h"
#include "sim/world/world.h"

namespace v2vouch::sim {
namespace {

std::unique_ptr<World> Campaign(const std::string& name, int vehicles, std::uint64_t seed,
                                std::vector<std::string>& problems) {
  Scenario scenario;
  if (!LoadScenario("sim/scenarios/" + name + ".yaml", scenario, problems)) return nullptr;
  scenario.traffic.vehicles = vehicles;
  return World::Make(scenario, seed, problems);
}

std::vector<const Actor*> Drawn(const World& world) {
  std::vector<const Actor*> drawn;
  for (const Actor& actor : world.actors()) {
    if (actor.id >= kFirstTrafficId) drawn.push_back(&actor);
  }
  return drawn;
}

class Traffic : public testing::TestWithParam<const char*> {};

TEST_P(Traffic, IsTheSameForTheSameSeedAndADenserOneHoldsTheThinner) {
  std::vector<std::string> problems;
  const auto thin = Campaign(GetParam(), 5, 11, problems);
  const auto dense = Campaign(GetParam(), 60, 11, problems);
  const auto other = Campaign(GetParam(), 5, 12, problems);
  ASSERT_TRUE(thin && dense && other) << problems.front();
  const auto few = Drawn(*thin);
  const auto many = Drawn(*dense);
  const auto others = Drawn(*other);
  ASSERT_EQ(few.size(), 5u);
  ASSERT_EQ(many.size(), 60u);
  bool differs = false;
  int talk = 0;
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i]->trajectory.At(20.0).centre, many[i]->trajectory.At(20.0).centre);
    EXPECT_EQ(few[i]->has_v2v, many[i]->has_v2v);
    differs = differs || few[i]->trajectory.At(0.0).centre != others[i]->trajectory.At(0.0).centre;
  }
  for (const Actor* actor : many) talk += actor->has_v2v ? 1 : 0;
  EXPECT_TRUE(differs);
  EXPECT_NEAR(talk, 30, 15);  // Half of 60; four sigma of a binomial are 15.5.
}

void ExpectNobodyTouches(const World& world, const std::string& what) {
  const VehicleConfig& car = world.scenario().vehicle;
  for (double t = 0.0; t <= world.scenario().duration_s; t += 0.5) {
    const Snapshot snapshot = world.At(t);
    std::vector<std::pair<std::uint32_t, Box>> boxes = {
        {0,
         {snapshot.ego.PointAt(car.centre_x_m, 0.0), snapshot.ego.yaw_rad, car.length_m,
          car.width_m}}};
    for (const ActorState& actor : snapshot.actors) {
      boxes.emplace_back(actor.actor->id, actor.box());
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        if ((boxes[i].second.centre - boxes[k].second.centre).norm() > 20.0) continue;
        ASSERT_FALSE(Overlap(boxes[i].second, boxes[k].second))
            << what << ": vehicles " << boxes[k].first << " and " << boxes[i].first << " at " << t
            << " s";
      }
    }
  }
}

// Whatever is drawn keeps its distance from all others at all times, on many seeds.
TEST_P(Traffic, NobodyTouchesAnybody) {
  for (std::uint64_t seed = 11; seed <= 16; ++seed) {
    std::vector<std::string> problems;
    const auto world = Campaign(GetParam(), 60, seed, problems);
    ASSERT_NE(world, nullptr) << problems.front();
    ExpectNobodyTouches(*world, "seed " + std::to_string(seed));
  }
}

TEST(Manoeuvres, OfTheHonestSetTouchNobody) {
  const std::pair<const char*, const char*> cases[] = {{"campaign_urban", "H09_braking_urban"},
                                                       {"campaign_urban", "H09_turns"},
                                                       {"campaign_highway", "H09_braking_highway"}};
  for (const auto& [name, overlay] : cases) {
    Scenario scenario;
    std::vector<std::string> problems;
    ASSERT_TRUE(LoadScenario(std::string("sim/scenarios/") + name + ".yaml", scenario, problems));
    ASSERT_TRUE(
        LayOver(std::string("sim/attacks/catalogue/") + overlay + ".yaml", scenario, problems));
    ASSERT_TRUE(CheckReferences(scenario, problems));
    scenario.traffic.vehicles = 20;
    const auto world = World::Make(scenario, 11, problems);
    ASSERT_NE(world, nullptr) << problems.front();
    ExpectNobodyTouches(*world, overlay);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Traffic, testing::Values("campaign_urban", "campaign_highway"));

TEST(AddTraffic, SaysHowManyFitWhereNotAllDo) {
  std::vector<std::string> problems;
  EXPECT_EQ(Campaign("campaign_highway", 900, 11, problems), nullptr);
  EXPECT_THAT(problems, testing::ElementsAre(testing::HasSubstr("traffic.vehicles = 900: the lanes "
                                                                "have room for ")));
}

TEST(AddTraffic, LanesAreNeededAndTheirRoutesToo) {
  Scenario scenario;
  std::vector<std::string> problems;
  ASSERT_TRUE(LoadScenario("sim/scenarios/smoke.yaml", scenario, problems));
  scenario.traffic.vehicles = 3;
  EXPECT_FALSE(CheckReferences(scenario, problems));
  EXPECT_THAT(problems, testing::ElementsAre(testing::HasSubstr("names no lane with a weight")));
  problems.clear();
  scenario.traffic.lanes.push_back({.route = "nowhere"});
  EXPECT_FALSE(CheckReferences(scenario, problems));
  EXPECT_THAT(problems, testing::ElementsAre(testing::HasSubstr("no route is called 'nowhere'")));
}

}  // namespace
}  // namespace v2vouch::sim
