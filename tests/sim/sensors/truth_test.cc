// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/truth.h"

#include <gtest/gtest.h>

#include "tests/sim/sensors/scene.h"

namespace v2vouch::sim {
namespace {

TEST(TruthWriter, ListsEveryVehicleNearbyAndSaysWhatIsHidden) {
  Scenario scenario = StandingEgo();
  AddVehicle(scenario, 1, 40.0, 0.0, 0.0);  // Behind the truck.
  AddVehicle(scenario, 2, 25.0, 0.0, 0.0, 0.0, ObjectClass::kTruck);
  AddVehicle(scenario, 3, -30.0, 0.0, 0.0);  // Behind the ego.
  AddVehicle(scenario, 4, 400.0, 0.0, 0.0);  // Far away.
  scenario.parked.push_back({.id = 5, .x_m = 30.0, .y_m = 8.0});
  const auto world = MakeWorld(scenario);
  TruthWriter writer(*world, 1);
  truth_list_t truth{};
  writer.Write(world->At(2.0), 0, truth);
  ASSERT_EQ(truth.objects.size(), 4u);
  EXPECT_EQ(truth.objects[0].is_hidden, 1);
  EXPECT_EQ(truth.objects[1].is_hidden, 0);
  EXPECT_EQ(truth.objects[2].is_hidden, 1);
  EXPECT_EQ(truth.objects[3].id, 5);
  EXPECT_EQ(truth.objects[3].is_hidden, 0);
  EXPECT_EQ(truth.objects[3].speed_mps, 0.0);
  ASSERT_EQ(truth.objects[1].sensors.size(), 4u);
  EXPECT_EQ(truth.objects[1].sensors[0].sensor, "RADAR_FRONT");
  EXPECT_EQ(truth.objects[1].sensors[3].sensor, "CAMERA_FRONT");
  EXPECT_NEAR(truth.objects[1].sensors[0].detection_probability,
              scenario.vehicle.radars[0].detection_probability, 1e-12);
}

}  // namespace
}  // namespace v2vouch::sim
