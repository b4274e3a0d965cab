// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/objects.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/sensors/scene.h"

namespace v2vouch::sim {
namespace {

Scenario Scene(SensorMode mode) {
  Scenario scenario = StandingEgo();
  scenario.sensors.mode = mode;
  scenario.vehicle.objects = {ObjectSensorConfig{.x_m = 1.0, .yaw_rad = 0.5 * kPi}};
  scenario.vehicle.objects[0].clutter_per_frame = 0.0;
  return scenario;
}

struct Mean {
  double count = 0.0, x = 0.0, y = 0.0, squares = 0.0;
};

Mean Observe(const World& world, int frames, double true_x, double true_y) {
  ObjectSimulator source(world, 0, 7);
  const Snapshot snapshot = world.At(1.0);
  Mean mean;
  object_list_t list{};
  for (int seq = 0; seq < frames; ++seq) {
    source.Detect(snapshot, seq, list);
    EXPECT_EQ(list.num_objects, static_cast<std::int32_t>(list.objects.size()));
    for (const object_t& object : list.objects) {
      mean.count += 1.0;
      mean.x += object.x_m;
      mean.y += object.y_m;
      mean.squares += std::pow(object.x_m - true_x, 2) + std::pow(object.y_m - true_y, 2);
    }
  }
  mean.x /= mean.count;
  mean.y /= mean.count;
  return mean;
}

// The sensor looks to the left: what is 20 m to the left of it is 20 m ahead in its own frame.
TEST(ObjectSimulator, TellsTheCentreInItsOwnFrameWithTheConfiguredNoise) {
  Scenario scenario = Scene(SensorMode::kIdealPoints);
  AddVehicle(scenario, 1, 4.0, 20.0, 0.0);
  const auto world = MakeWorld(scenario);
  constexpr int kFrames = 4000;
  const Mean mean = Observe(*world, kFrames, 20.0, -3.0);
  const ObjectSensorConfig& config = scenario.vehicle.objects[0];
  EXPECT_NEAR(mean.count / kFrames, config.detection_probability, 0.015);
  EXPECT_NEAR(mean.x, 20.0, 5.0 * config.position_sigma_m / 60.0);
  EXPECT_NEAR(mean.y, -3.0, 5.0 * config.position_sigma_m / 60.0);
  EXPECT_NEAR(std::sqrt(0.5 * mean.squares / mean.count) / config.position_sigma_m, 1.0, 0.06);
}

TEST(ObjectSimulator, WhatIsCoveredIsMissedAndWhatIsHalfCoveredIsDrawnNearer) {
  Scenario scenario = Scene(SensorMode::kRealistic);
  AddVehicle(scenario, 1, 1.0, 40.0, 0.0);
  const auto free = MakeWorld(scenario);
  AddVehicle(scenario, 2, 1.0, 20.0, 0.0, 0.0, ObjectClass::kTruck);
  const auto covered = MakeWorld(scenario);
  std::vector<Sight> sights;
  ObjectSimulator(*free, 0, 7).Look(free->At(1.0), sights);
  EXPECT_GT(sights[0].detection_probability, 0.85);
  ObjectSimulator(*covered, 0, 7).Look(covered->At(1.0), sights);
  EXPECT_EQ(sights[0].detection_probability, 0.0);
  EXPECT_GT(sights[1].detection_probability, 0.85);
}

TEST(ObjectSimulator, TellsVelocityCovarianceAndIdsWhereAskedTo) {
  Scenario scenario = Scene(SensorMode::kIdealPoints);
  scenario.sensors.noise_scale = 0.0;
  scenario.vehicle.objects[0].detection_probability = 0.999;
  AddVehicle(scenario, 5, 4.0, 20.0, 0.0, 8.0);
  object_list_t list{};
  const auto shy = MakeWorld(scenario);
  ObjectSimulator(*shy, 0, 7).Detect(shy->At(1.0), 0, list);
  ASSERT_EQ(list.objects.size(), 1U);
  EXPECT_TRUE(std::isnan(list.objects[0].velocity_x_mps));
  EXPECT_EQ(list.objects[0].covariance[0], 0.0);
  EXPECT_EQ(list.objects[0].id, -1);
  scenario.sensors.objects_tell_velocity = true;
  scenario.sensors.objects_tell_covariance = true;
  scenario.sensors.objects_tell_ids = true;
  scenario.sensors.noise_scale = 0.001;
  const auto frank = MakeWorld(scenario);
  ObjectSimulator(*frank, 0, 7).Detect(frank->At(1.0), 0, list);
  ASSERT_EQ(list.objects.size(), 1U);
  EXPECT_NEAR(list.objects[0].velocity_x_mps, 0.0, 0.01);
  EXPECT_NEAR(list.objects[0].velocity_y_mps, -8.0, 0.01) << "east is to the sensor's right";
  EXPECT_GT(list.objects[0].covariance[24], 0.0);
  EXPECT_EQ(list.objects[0].id, 5);
}

TEST(ObjectSimulator, FalseBoxesComeAtTheConfiguredRateInsideItsView) {
  Scenario scenario = Scene(SensorMode::kRealistic);
  scenario.vehicle.objects[0].clutter_per_frame = 0.4;
  scenario.vehicle.objects[0].half_fov_rad = FromDegrees(40.0);
  const auto world = MakeWorld(scenario);
  ObjectSimulator source(*world, 0, 7);
  const Snapshot snapshot = world->At(1.0);
  object_list_t list{};
  double count = 0.0;
  for (int seq = 0; seq < 4000; ++seq) {
    source.Detect(snapshot, seq, list);
    for (const object_t& object : list.objects) {
      count += 1.0;
      EXPECT_LE(std::abs(std::atan2(object.y_m, object.x_m)), FromDegrees(40.0) + 1e-9);
      EXPECT_LE(std::hypot(object.x_m, object.y_m), 80.0);
    }
  }
  EXPECT_NEAR(count / 4000.0, 0.4, 0.05);
}

}  // namespace
}  // namespace v2vouch::sim
