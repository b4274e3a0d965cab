// SPDX-License-Identifier: Apache-2.0
#include "sim/world/scenario.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "daemon/rim/config/yaml_reader.h"
#include "sim/world/world.h"

namespace v2vouch::sim {
namespace {

std::unique_ptr<World> Shipped(const std::string& name) {
  Scenario scenario;
  std::vector<std::string> problems;
  std::unique_ptr<World> world;
  if (LoadScenario("sim/scenarios/" + name + ".yaml", scenario, problems)) {
    world = World::Make(scenario, 1, problems);
  }
  for (const std::string& problem : problems) ADD_FAILURE() << problem;
  return world;
}

class ShippedScenario : public testing::TestWithParam<const char*> {};

TEST_P(ShippedScenario, NobodyDrivesIntoAnybodyOrAHouse) {
  const auto world = Shipped(GetParam());
  ASSERT_NE(world, nullptr);
  const VehicleConfig& car = world->scenario().vehicle;
  for (double t = 0.0; t <= world->scenario().duration_s; t += 0.2) {
    const Snapshot snapshot = world->At(t);
    std::vector<std::pair<std::uint32_t, Box>> boxes = {
        {0,
         {snapshot.ego.PointAt(car.centre_x_m, 0.0), snapshot.ego.yaw_rad, car.length_m,
          car.width_m}}};
    for (const ActorState& actor : snapshot.actors) {
      boxes.emplace_back(actor.actor->id, actor.box());
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        EXPECT_FALSE(Overlap(boxes[i].second, boxes[k].second))
            << "vehicles " << boxes[k].first << " and " << boxes[i].first << " at " << t << " s";
      }
      const auto corners = boxes[i].second.Corners();
      for (const Wall& wall : world->walls()) {
        for (std::size_t k = 0; k < 4; ++k) {
          EXPECT_FALSE(LineCrossesOutline(corners[k], corners[(k + 1) % 4], wall.outline))
              << "vehicle " << boxes[i].first << " at " << t << " s";
        }
      }
    }
  }
}

TEST_P(ShippedScenario, EffectiveTextReadsBackAsTheSame) {
  const auto world = Shipped(GetParam());
  ASSERT_NE(world, nullptr);
  const std::string text = ToYaml(world->scenario());
  Scenario again;
  std::vector<std::string> problems;
  ASSERT_TRUE(config::Parse(text, "again", again, problems)) << problems.front();
  EXPECT_EQ(ToYaml(again), text);
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScenario,
                         testing::Values("left_turn", "urban", "highway", "occlusion", "smoke",
                                         "campaign_urban", "campaign_highway", "ghosts",
                                         "calibration_drive", "calibration_straight",
                                         "calibration_parked", "calibration_same_bearing",
                                         "calibration_constant_speed", "calibration_one_remote"));

TEST(LoadScenario, ReportsEveryProblemWithItsPlace) {
  const auto path = std::filesystem::temp_directory_path() / "v2vouch_bad_scenario.yaml";
  std::ofstream(path) << "name: bad\nduration_s: -3\nspeeed: 4\n";
  Scenario scenario;
  std::vector<std::string> problems;
  EXPECT_FALSE(LoadScenario(path.string(), scenario, problems));
  EXPECT_EQ(problems.size(), 2u);

  problems.clear();
  std::ofstream(path) << "name: bad\nego: {drive: {route: nowhere}}\n"
                      << "vehicles: [{id: 3, drive: {route: a}}, {id: 3, drive: {route: a}}]\n";
  Scenario other;
  EXPECT_FALSE(LoadScenario(path.string(), other, problems));
  EXPECT_EQ(problems.size(), 4u);  // Ego's route, the double id, both vehicles' route.
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace v2vouch::sim
