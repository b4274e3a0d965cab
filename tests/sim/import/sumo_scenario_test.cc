// SPDX-License-Identifier: Apache-2.0
#include "sim/import/sumo_scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "daemon/common/base/angle.h"
#include "sim/import/intersection.h"
#include "sim/world/scenario.h"
#include "sim/world/trajectory.h"
#include "tests/sim/import/files.h"

namespace v2vouch::sim {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kSpeed_mps = 8.0;

// Straight through the crossing at (0, 0) in direction `heading_rad`, on the right-hand lane.
FcdVehicle Through(const std::string& id, double heading_rad) {
  FcdVehicle vehicle{id, "car", {}};
  const Eigen::Vector2d along(std::cos(heading_rad), std::sin(heading_rad));
  const Eigen::Vector2d right(along.y(), -along.x());
  for (int k = 0; k <= 200; ++k) {
    const double t_s = 0.1 * k;
    vehicle.samples.push_back(
        {t_s, (kSpeed_mps * t_s - 80.0) * along + 1.6 * right, heading_rad, 51.0, 7.0});
  }
  return vehicle;
}

// Comes from the west and turns left to the north on a circle of 10 m.
FcdVehicle LeftTurner(const std::string& id) {
  constexpr double kRadius_m = 10.0;
  const Eigen::Vector2d pivot(-8.4, 8.4);  // The circle starts on the right-hand lane, y = -1.6.
  FcdVehicle vehicle{id, "car", {}};
  for (int k = 0; k <= 200; ++k) {
    const double t_s = 0.1 * k;
    const double driven_m = kSpeed_mps * t_s - 80.0;  // 0 where the circle starts.
    const double turned = std::clamp(driven_m / kRadius_m, 0.0, 0.5 * kPi);
    Eigen::Vector2d place =
        pivot + kRadius_m * Eigen::Vector2d(std::sin(turned), -std::cos(turned));
    if (driven_m < 0.0) place.x() += driven_m;
    place.y() += std::max(0.0, driven_m - 0.5 * kPi * kRadius_m);
    vehicle.samples.push_back({t_s, place, turned, 51.0, 7.0});
  }
  return vehicle;
}

std::vector<FcdVehicle> Crossing() {
  return {Through("east", 0.0), LeftTurner("left"), Through("west", kPi),
          Through("north", 0.5 * kPi), Through("south", -0.5 * kPi)};
}

std::vector<std::vector<CentreSample>> MotionsOf(const std::vector<FcdVehicle>& vehicles) {
  std::vector<std::vector<CentreSample>> motions;
  for (const FcdVehicle& vehicle : vehicles) motions.push_back(CentreMotion(vehicle, {}));
  return motions;
}

TEST(BusiestLeftTurn, IsTheOnlyVehicleThatTurnsLeftAndMeetsTheOncomingOne) {
  const auto turn = BusiestLeftTurn(MotionsOf(Crossing()), std::vector<FcdBody>(5));
  ASSERT_TRUE(turn);
  EXPECT_EQ(turn->vehicle, 1u);
  EXPECT_NEAR(turn->middle_s, 11.2, 1.0);
  EXPECT_GT(turn->oncoming_s, 5.0);
}

TEST(BusiestLeftTurn, PassesOverOneThatTouchesAnother) {
  auto vehicles = Crossing();
  FcdVehicle parked{"parked", "car", {}};  // In the way of the first turner.
  for (int k = 0; k <= 200; ++k) {
    parked.samples.push_back({0.1 * k, {-12.0, -1.6}, 0.0, 51.0, 7.0});
  }
  vehicles.push_back(parked);
  vehicles.push_back(LeftTurner("farther out"));
  for (FcdSample& sample : vehicles.back().samples) sample.front.y() -= 20.0;
  const auto turn = BusiestLeftTurn(MotionsOf(vehicles), std::vector<FcdBody>(7));
  ASSERT_TRUE(turn);
  EXPECT_EQ(turn->vehicle, 6u);
}

TEST(CornerBuildings, StandInAllFourCornersClearOfEveryWay) {
  const auto motions = MotionsOf(Crossing());
  const auto houses = CornerBuildings({0.0, 0.0}, motions, 7.0);
  ASSERT_EQ(houses.size(), 4u);
  for (const CornerBuilding& house : houses) {
    for (const auto& motion : motions) {
      for (const CentreSample& sample : motion) {
        const Eigen::Vector2d to = sample.centre - house.centre;
        const double x = to.x() * std::cos(house.yaw_rad) + to.y() * std::sin(house.yaw_rad);
        const double y = -to.x() * std::sin(house.yaw_rad) + to.y() * std::cos(house.yaw_rad);
        const double outside = std::hypot(std::max(0.0, std::abs(x) - 0.5 * house.length_m),
                                          std::max(0.0, std::abs(y) - 0.5 * house.width_m));
        ASSERT_GE(outside, 7.0 - 1e-9);
      }
    }
  }
}

TEST(MakeSumoScenario, TheEgoIsNumberOneAndTurnsAtTheOrigin) {
  SumoScenario scenario;
  std::string error;
  ASSERT_TRUE(MakeSumoScenario(Crossing(), {}, scenario, error)) << error;
  EXPECT_EQ(scenario.ego, "left");
  EXPECT_EQ(scenario.vehicles, 4u);
  EXPECT_EQ(scenario.buildings, 4u);
  EXPECT_THAT(scenario.yaml, HasSubstr("ego: {trajectory_id: 1}"));
  std::istringstream rows(scenario.trajectories_csv);
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "time_s,id,class,x_m,y_m,yaw_rad,speed_mps,length_m,width_m");
  double nearest_m = 1e9;
  bool is_first = true;
  while (std::getline(rows, row)) {
    double time_s = 0.0;
    int id = 0;
    double x_m = 0.0;
    double y_m = 0.0;
    ASSERT_EQ(std::sscanf(row.c_str(), "%lf,%d,%*[^,],%lf,%lf", &time_s, &id, &x_m, &y_m), 4);
    if (is_first) {
      EXPECT_EQ(time_s, 0.0);
      is_first = false;
    }
    if (id == 1) nearest_m = std::min(nearest_m, std::hypot(x_m, y_m));
  }
  EXPECT_LT(nearest_m, 0.5);
}

TEST(MakeSumoScenario, VansAreDrawnFromTheSeedAndNeverTheEgo) {
  SumoOptions options;
  options.van_share = 1.0;
  SumoScenario all;
  SumoScenario again;
  std::string error;
  ASSERT_TRUE(MakeSumoScenario(Crossing(), options, all, error));
  ASSERT_TRUE(MakeSumoScenario(Crossing(), options, again, error));
  EXPECT_EQ(all.trajectories_csv, again.trajectories_csv);
  EXPECT_THAT(all.trajectories_csv, HasSubstr(",2,van,"));
  EXPECT_THAT(all.trajectories_csv, Not(HasSubstr(",1,van,")));
  options.van_share = 0.0;
  SumoScenario none;
  ASSERT_TRUE(MakeSumoScenario(Crossing(), options, none, error));
  EXPECT_THAT(none.trajectories_csv, Not(HasSubstr("van")));
}

TEST(MakeSumoScenario, AnUnknownEgoOrNoLeftTurnerIsAnError) {
  SumoOptions options;
  options.ego = "nobody";
  SumoScenario scenario;
  std::string error;
  EXPECT_FALSE(MakeSumoScenario(Crossing(), options, scenario, error));
  EXPECT_THAT(error, HasSubstr("\"nobody\""));
  EXPECT_FALSE(MakeSumoScenario({Through("east", 0.0)}, {}, scenario, error));
  EXPECT_THAT(error, HasSubstr("no vehicle turns left"));
}

TEST(MakeSumoScenario, AnEgoThatDoesNotTurnIsTakenWhenNamed) {
  SumoOptions options;
  options.ego = "east";
  options.has_buildings = false;
  SumoScenario scenario;
  std::string error;
  ASSERT_TRUE(MakeSumoScenario(Crossing(), options, scenario, error)) << error;
  EXPECT_EQ(scenario.ego, "east");
  EXPECT_THAT(scenario.yaml, Not(HasSubstr("buildings")));
}

// Real demand on a real intersection with unprotected left turns.
TEST(MakeSumoScenario, CologneGivesALeftTurnWithTrafficRoundIt) {
  const auto path = ReferenceData("traffic/cologne1/fcd_0.1s_180s.csv.gz");
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << "SKIPPED: no " << path << " (set V2VOUCH_DATA)";
  }
  std::string error;
  const auto vehicles = ReadFcd(path.string(), error);
  ASSERT_GE(vehicles.size(), 105u) << error;  // 105 SUMO ids.
  SumoScenario scenario;
  ASSERT_TRUE(MakeSumoScenario(vehicles, {}, scenario, error)) << error;
  EXPECT_GT(scenario.duration_s, 12.0);
  EXPECT_GE(scenario.vehicles, 10u);
  EXPECT_GE(scenario.buildings, 2u);
  const ScratchFolder folder("cologne");
  const std::string file = folder.Write("scenario.yaml", scenario.yaml);
  folder.Write("trajectories.csv", scenario.trajectories_csv);
  Scenario loaded;
  std::vector<std::string> problems;
  EXPECT_TRUE(LoadScenario(file, loaded, problems)) << testing::PrintToString(problems);
}

// What is written is what the simulator reads.
TEST(MakeSumoScenario, TheSimulatorLoadsItWithEveryVehicle) {
  SumoScenario made;
  std::string error;
  ASSERT_TRUE(MakeSumoScenario(Crossing(), {}, made, error)) << error;
  const ScratchFolder folder("crossing");
  Scenario scenario;
  std::vector<std::string> problems;
  ASSERT_TRUE(LoadScenario(folder.Write("scenario.yaml", made.yaml), scenario, problems))
      << testing::PrintToString(problems);
  EXPECT_EQ(scenario.ego.trajectory_id, 1u);
  EXPECT_EQ(scenario.v2v_share, 0.5);
  EXPECT_EQ(scenario.buildings.size(), 4u);
  std::map<std::uint32_t, Recorded> vehicles;
  ASSERT_TRUE(
      LoadTrajectories(folder.Write("trajectories.csv", made.trajectories_csv), vehicles, problems))
      << testing::PrintToString(problems);
  EXPECT_EQ(vehicles.size(), 5u);
}

}  // namespace
}  // namespace v2vouch::sim
