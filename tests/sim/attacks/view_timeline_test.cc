// SPDX-License-Identifier: Apache-2.0
// What the campaign scenarios offer, by truth geometry: long joint views, occlusions of about 4 s.
#include "sim/attacks/view_timeline.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/sim/attacks/radio_run.h"

namespace v2vouch::sim {
namespace {

std::size_t IndexOf(const World& world, std::uint32_t id) {
  for (std::size_t i = 0; i < world.actors().size(); ++i) {
    if (world.actors()[i].id == id) return i;
  }
  ADD_FAILURE() << "no vehicle " << id;
  return 0;
}

class Campaign : public testing::TestWithParam<const char*> {};

TEST_P(Campaign, HalfOfThoseWhoTalkAndMoreAreInJointViewForFourSeconds) {
  int talk = 0;
  int seen = 0;
  for (std::uint64_t seed = 11; seed <= 13; ++seed) {
    Scenario scenario = CampaignScenario(GetParam(), "");
    scenario.traffic.vehicles = 20;
    std::vector<std::string> problems;
    const auto world = World::Make(scenario, seed, problems);
    ASSERT_NE(world, nullptr);
    const ViewTimeline views(*world, seed);
    for (std::size_t i = 0; i < world->actors().size(); ++i) {
      if (!world->actors()[i].has_v2v) continue;
      ++talk;
      seen += views.LongestInView(i) >= 4.0 ? 1 : 0;
    }
  }
  // Measured with this code: 25 of 47 in the street, 23 of 38 on the highway.
  EXPECT_GE(seen, 0.5 * talk) << seen << " of " << talk;
}

INSTANTIATE_TEST_SUITE_P(All, Campaign, testing::Values("campaign_urban", "campaign_highway"));

void ExpectHiddenForFourSeconds(const std::string& name, const std::vector<std::uint32_t>& ids) {
  Scenario scenario = CampaignScenario(name, "");
  scenario.traffic.vehicles = 0;
  std::vector<std::string> problems;
  const auto world = World::Make(scenario, 11, problems);
  ASSERT_NE(world, nullptr);
  const ViewTimeline views(*world, 11);
  for (const std::uint32_t id : ids) {
    const std::size_t i = IndexOf(*world, id);
    EXPECT_GE(views.LongestHidden(i), 3.0) << "vehicle " << id;
    EXPECT_LE(views.LongestHidden(i), 6.0) << "vehicle " << id;
    EXPECT_GE(views.LongestInView(i), 2.0) << "vehicle " << id;
  }
}

TEST(CampaignUrban, TheLorryHidesOncomingCarsForAboutFourSeconds) {
  ExpectHiddenForFourSeconds("campaign_urban", {4, 5, 6});
}

TEST(CampaignHighway, TrucksHideTheCarsBesideThemForAboutFourSeconds) {
  ExpectHiddenForFourSeconds("campaign_highway", {3, 4});
}

}  // namespace
}  // namespace v2vouch::sim
