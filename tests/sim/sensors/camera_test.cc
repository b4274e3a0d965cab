// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/sensors/scene.h"

namespace v2vouch::sim {
namespace {

TEST(Project, PinholeByHand) {
  CameraConfig camera;  // At (1.8, 0, 1.4), f = 1000, centre 640, 360.
  const auto pixel = Project(camera, {21.8, 2.0, 0.0});
  ASSERT_TRUE(pixel.has_value());
  EXPECT_NEAR(pixel->x(), 640.0 - 1000.0 * 2.0 / 20.0, 1e-9);
  EXPECT_NEAR(pixel->y(), 360.0 + 1000.0 * 1.4 / 20.0, 1e-9);
  EXPECT_FALSE(Project(camera, {1.9, 0.0, 1.0}).has_value());
}

TEST(Project, MountingAnglesTurnTheRightWay) {
  CameraConfig camera;
  camera.yaw_rad = 0.1;  // Looks to the left: straight ahead moves right in the picture.
  EXPECT_NEAR(Project(camera, {51.8, 0.0, 1.4})->x(), 640.0 + 1000.0 * std::tan(0.1), 1e-9);
  camera.yaw_rad = 0.0;
  camera.pitch_rad = 0.1;  // Looks down: the horizon moves up.
  EXPECT_NEAR(Project(camera, {51.8, 0.0, 1.4})->y(), 360.0 - 1000.0 * std::tan(0.1), 1e-9);
  camera.pitch_rad = 0.0;
  camera.roll_rad = 0.1;  // Right side down: what is on the right moves up.
  EXPECT_LT(Project(camera, {51.8, -10.0, 1.4})->y(), 360.0);
}

TEST(Project, DistortionIsOpenCvs) {
  CameraConfig camera;
  camera.distortion = {-0.3, 0.1, 0.001, -0.002, 0.05};
  // cv::projectPoints for the point (0.4, -0.2, 1), written out by hand.
  const double x = 0.4;
  const double y = -0.2;
  const double r2 = 0.2;
  const double radial = 1.0 - 0.3 * r2 + 0.1 * r2 * r2 + 0.05 * r2 * r2 * r2;
  const double u = x * radial + 2 * 0.001 * x * y - 0.002 * (r2 + 2 * x * x);
  const double v = y * radial + 0.001 * (r2 + 2 * y * y) - 2 * 0.002 * x * y;
  const auto pixel = Project(camera, {11.8, -4.0, 3.4});
  ASSERT_TRUE(pixel.has_value());
  EXPECT_NEAR(pixel->x(), 640.0 + 1000.0 * u, 1e-9);
  EXPECT_NEAR(pixel->y(), 360.0 + 1000.0 * v, 1e-9);
}

Scenario QuietScene() {
  Scenario scenario = StandingEgo();
  scenario.sensors.clutter_scale = 0.0;
  scenario.sensors.noise_scale = 0.0;
  return scenario;
}

camera_detections_t FirstPictureWithBoxes(CameraSimulator& camera, const Snapshot& snapshot) {
  camera_detections_t picture{};
  for (int seq = 0; picture.boxes.empty() && seq < 100; ++seq) {
    camera.Shoot(snapshot, seq, picture);
  }
  return picture;
}

TEST(CameraSimulator, BoxOfACarAheadIsItsRear) {
  Scenario scenario = QuietScene();
  AddVehicle(scenario, 1, 20.0, 0.0, 0.0);
  const auto world = MakeWorld(scenario);
  CameraSimulator camera(*world, 0, 3);
  const auto picture = FirstPictureWithBoxes(camera, world->At(0.0));
  ASSERT_EQ(picture.boxes.size(), 1u);
  // The centre stands on the route's first waypoint at time 0, so the rear is half a length nearer.
  const double range = 20.0 - 0.5 * 4.5 - 1.8;
  EXPECT_NEAR(picture.boxes[0].width_px, 1000.0 * 1.8 / range, 0.01);
  EXPECT_NEAR(picture.boxes[0].top_px + picture.boxes[0].height_px, 360.0 + 1000.0 * 1.4 / range,
              0.01);
  EXPECT_NEAR(picture.boxes[0].left_px, 640.0 - 500.0 * 1.8 / range, 0.01);
}

TEST(CameraSimulator, CoveredPartsAreCutAwayAndHiddenCarsGiveNothing) {
  Scenario scenario = QuietScene();
  AddVehicle(scenario, 1, 40.0, 0.0, 0.0);
  AddVehicle(scenario, 2, 25.0, 1.1, 0.0, 0.0, ObjectClass::kTruck);  // Covers the left part.
  const auto world = MakeWorld(scenario);
  CameraSimulator camera(*world, 0, 3);
  std::vector<Sight> sights;
  camera.Look(world->At(0.0), sights);
  EXPECT_GT(sights[0].visible_fraction, 0.05);
  EXPECT_LT(sights[0].visible_fraction, 0.95);
  EXPECT_GT(sights[1].visible_fraction, 0.99);

  Scenario hidden = QuietScene();
  AddVehicle(hidden, 1, 40.0, 0.0, 0.0);
  AddVehicle(hidden, 2, 25.0, 0.0, 0.0, 0.0, ObjectClass::kTruck);
  const auto dark = MakeWorld(hidden);
  CameraSimulator other(*dark, 0, 3);
  other.Look(dark->At(0.0), sights);
  EXPECT_EQ(sights[0].visible_fraction, 0.0);
  EXPECT_EQ(sights[0].detection_probability, 0.0);
}

TEST(CameraSimulator, ATruckIsSeenOverACar) {
  Scenario scenario = QuietScene();
  AddVehicle(scenario, 1, 40.0, 0.0, 0.0, 0.0, ObjectClass::kTruck);
  AddVehicle(scenario, 2, 20.0, 0.0, 0.0);
  const auto world = MakeWorld(scenario);
  CameraSimulator camera(*world, 0, 3);
  std::vector<Sight> sights;
  camera.Look(world->At(0.0), sights);
  EXPECT_GT(sights[0].visible_fraction, 0.3);
}

TEST(CameraSimulator, EdgesHaveTheConfiguredNoise) {
  Scenario scenario = QuietScene();
  scenario.sensors.noise_scale = 1.0;
  scenario.vehicle.cameras[0].pitch_sigma_rad = 1e-9;
  AddVehicle(scenario, 1, 30.0, 0.0, 0.0);
  const auto world = MakeWorld(scenario);
  CameraSimulator camera(*world, 0, 3);
  const Snapshot snapshot = world->At(0.0);
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  camera_detections_t picture{};
  for (int seq = 0; seq < 2000; ++seq) {
    camera.Shoot(snapshot, seq, picture);
    if (picture.boxes.empty()) continue;
    sum += picture.boxes[0].left_px;
    squares += picture.boxes[0].left_px * picture.boxes[0].left_px;
    ++count;
  }
  EXPECT_NEAR(count / 2000.0, scenario.vehicle.cameras[0].detection_probability, 0.025);
  const double mean = sum / count;
  EXPECT_NEAR(std::sqrt(squares / count - mean * mean), scenario.vehicle.cameras[0].edge_sigma_px,
              0.15);
}

TEST(CameraSimulator, IdealPointStandsOnTheGroundUnderTheCentre) {
  Scenario scenario = QuietScene();
  scenario.sensors.mode = SensorMode::kIdealPoints;
  AddVehicle(scenario, 1, 30.0, 3.0, 0.3);
  const auto world = MakeWorld(scenario);
  const Snapshot snapshot = world->At(0.0);
  CameraSimulator camera(*world, 0, 3);
  const auto picture = FirstPictureWithBoxes(camera, snapshot);
  ASSERT_EQ(picture.boxes.size(), 1u);
  const Vec2 centre = snapshot.actors[0].motion.centre;
  const auto foot = Project(scenario.vehicle.cameras[0], {centre.x(), centre.y(), 0.0});
  EXPECT_NEAR(picture.boxes[0].left_px + 0.5 * picture.boxes[0].width_px, foot->x(), 1e-6);
  EXPECT_NEAR(picture.boxes[0].top_px + picture.boxes[0].height_px, foot->y(), 1e-6);
}

}  // namespace
}  // namespace v2vouch::sim
