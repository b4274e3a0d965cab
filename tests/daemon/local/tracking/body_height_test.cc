// SPDX-License-Identifier: Apache-2.0
// A network's name is evidence; a lorry is never as low as a car.
#include "daemon/local/tracking/body_height.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/daemon/local/tracking/scene.h"

namespace v2vouch {
namespace {

class BodyHeightTest : public ::testing::Test {
 protected:
  CameraMeasurement BoxOf(double height_m, double range_m) const {
    CameraMeasurement z;
    z.top_depression_rad = std::atan2(camera_.z_m - height_m, range_m);
    z.depression_sigma_rad = 0.003;
    return z;
  }
  // What so many boxes of a body make of a name.
  ObjectClass Told(ObjectClass named, double height_m, double range_m, int boxes = 30) const {
    BodyHeight height;
    for (int i = 0; i < boxes; ++i) height.Add(look_, BoxOf(height_m, range_m), range_m);
    return height.Plausible(named);
  }

  const CameraConfig camera_ = OneRadarOneCamera().cameras[0];
  const EgoState ego_;
  const CameraLook look_{ego_, camera_};
};

TEST_F(BodyHeightTest, NamesThatFitStay) {
  EXPECT_EQ(Told(ObjectClass::kCar, 1.5, 30.0), ObjectClass::kCar);
  EXPECT_EQ(Told(ObjectClass::kVan, 2.3, 30.0), ObjectClass::kVan);
  EXPECT_EQ(Told(ObjectClass::kTruck, 3.6, 30.0), ObjectClass::kTruck);
  EXPECT_EQ(Told(ObjectClass::kBus, 3.1, 30.0), ObjectClass::kBus);
}

TEST_F(BodyHeightTest, ALorryIsNoCarAndACarNoLorry) {
  EXPECT_EQ(Told(ObjectClass::kCar, 3.6, 30.0), ObjectClass::kTruck);
  EXPECT_EQ(Told(ObjectClass::kVan, 3.6, 30.0), ObjectClass::kTruck);
  EXPECT_EQ(Told(ObjectClass::kTruck, 1.5, 30.0), ObjectClass::kCar);
  EXPECT_EQ(Told(ObjectClass::kBus, 2.2, 30.0), ObjectClass::kVan);
  EXPECT_EQ(Told(ObjectClass::kCar, 2.2, 30.0), ObjectClass::kVan);
}

TEST_F(BodyHeightTest, WhoWalksOrRidesKeepsItsName) {
  for (const auto named : {ObjectClass::kPedestrian, ObjectClass::kCyclist, ObjectClass::kUnknown,
                           ObjectClass::kMotorcycle}) {
    EXPECT_EQ(Told(named, 1.75, 20.0), named);
  }
}

// One box may be of anything, at the picture's border or far away it says nothing at all, and what
// is higher than any vehicle belongs to something behind it.
TEST_F(BodyHeightTest, NothingIsConcludedFromTooLittle) {
  EXPECT_EQ(Told(ObjectClass::kCar, 2.9, 60.0, 1), ObjectClass::kCar);
  EXPECT_EQ(Told(ObjectClass::kCar, 3.6, 120.0), ObjectClass::kCar);
  EXPECT_EQ(Told(ObjectClass::kCar, 6.2, 30.0), ObjectClass::kCar);
  BodyHeight cut;
  cut.Add(look_, CameraMeasurement{}, 10.0);
  EXPECT_EQ(cut.Plausible(ObjectClass::kCar), ObjectClass::kCar);
}

// Between two kinds what was told stays: sizes must not swing with a pixel.
TEST_F(BodyHeightTest, BetweenTwoKindsTheOlderStays) {
  BodyHeight height;
  for (int i = 0; i < 30; ++i) height.Add(look_, BoxOf(2.1, 20.0), 20.0);
  for (int i = 0; i < 200; ++i) {
    height.Add(look_, BoxOf(1.9, 20.0), 20.0);
    ASSERT_EQ(height.Plausible(ObjectClass::kCar), ObjectClass::kVan) << i;
  }
  for (int i = 0; i < 200; ++i) height.Add(look_, BoxOf(1.5, 20.0), 20.0);
  EXPECT_EQ(height.Plausible(ObjectClass::kTruck), ObjectClass::kCar);
}

// A lorry that is called a car all the time, seen by radar and camera.
TEST_F(BodyHeightTest, ATrackIsWhatItsHeightAllows) {
  Scene scene(5);
  scene.cars.push_back({.p_W = {35.0, 0.0}, .speed_mps = 12.0, .length_m = 10.0, .width_m = 2.5});
  scene.ego.speed_mps = 12.0;
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  for (int step = 0; step < 100; ++step) {
    scene.Advance(0.05);
    scene.Radar(tracker);
    auto boxes = scene.Picture(0);
    for (CameraMeasurement& z : boxes) z.top_depression_rad = BoxOf(3.6, 28.0).top_depression_rad;
    scene.Camera(tracker, boxes);
  }
  const LocalTrack* track = Scene::Find(tracker, scene.cars[0], 6.0);
  ASSERT_NE(track, nullptr);
  EXPECT_EQ(track->object_class, ObjectClass::kTruck);
  EXPECT_GT(track->extent.length_m + 2.0 * track->extent.length_sigma_m, 10.0);
}

}  // namespace
}  // namespace v2vouch
