// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/visibility/visibility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

constexpr int kFrontRadar = 0;
constexpr int kLeftRadar = 1;

Timestamp At(double seconds) { return FromMicros(1'000'000'000) + FromSeconds(seconds); }

EgoState Ego(double seconds = 0.0, Pose<Odometry, Body> X_OB = {}) {
  EgoState ego;
  ego.stamp = At(seconds);
  ego.X_OB = X_OB;
  return ego;
}

Occluder Car(std::uint64_t id, double x_m, double y_m, double yaw_rad = 0.0) {
  return {.id = id, .centre_O = {x_m, y_m}, .yaw_rad = yaw_rad};
}

Occluder Truck(std::uint64_t id, double x_m, double y_m, double yaw_rad = 0.0) {
  return {.id = id, .centre_O = {x_m, y_m}, .yaw_rad = yaw_rad, .length_m = 12.0, .width_m = 2.5};
}

// A standing return of the front radar at a place in O, while the ego stands at O's origin.
RadarMeasurement Standing(double x_m, double y_m) {
  RadarMeasurement m;
  m.radar = kFrontRadar;
  m.is_static = true;
  m.range_m = std::hypot(x_m - 3.75, y_m);
  m.azimuth_rad = std::atan2(y_m, x_m - 3.75);
  m.azimuth_min_rad = m.azimuth_max_rad = m.azimuth_rad;
  m.near_range_m = m.range_m;
  return m;
}

class VisibilityMapTest : public testing::Test {
 protected:
  void Scene(const std::vector<Occluder>& boxes, double seconds = 0.0) {
    map_.SetScene(Ego(seconds), boxes);
  }
  // Ten scans of returns at random places along a line, half of the sampled points answering.
  void AccumulateWall(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    Random random(6);
    const double length = (to - from).norm();
    for (int scan = 0; scan < 20; ++scan) {
      std::vector<RadarMeasurement> returns;
      for (double s = 0.0; s < length; s += random.Uniform(0.8, 3.0)) {
        const Eigen::Vector2d p = from + (to - from) * (s / length);
        returns.push_back(
            Standing(p.x() + random.Normal(0.0, 0.2), p.y() + random.Normal(0.0, 0.2)));
      }
      map_.AccumulateStatic(At(0.05 * scan), Ego(0.05 * scan), returns);
    }
  }
  View Front(const Occluder& footprint) const {
    return map_.From({SensorKind::kRadar, kFrontRadar}, footprint).view;
  }

  VisibilityMap map_{VisibilityConfig{}, VehicleConfig{}};
};

TEST_F(VisibilityMapTest, AnEmptySceneIsClearInsideFieldOfViewAndRange) {
  Scene({});
  const auto ahead = map_.From({SensorKind::kRadar, kFrontRadar}, Car(1, 50.0, 0.0));
  EXPECT_EQ(ahead.view, View::kClear);
  EXPECT_NEAR(ahead.uncovered, 1.0, 1e-12);
  EXPECT_EQ(map_.From({SensorKind::kCamera, 0}, Car(1, 50.0, 0.0)).view, View::kClear);
  EXPECT_EQ(Front(Car(1, 180.0, 0.0)), View::kOutOfView);  // Range 160 m.
  EXPECT_EQ(Front(Car(1, 20.0, 40.0)), View::kOutOfView);  // Beyond 30 degrees.
  EXPECT_EQ(Front(Car(1, -30.0, 0.0)), View::kOutOfView);
  EXPECT_EQ(map_.Overall(Car(1, 20.0, 40.0)), View::kClear);  // The corner radar's.
  EXPECT_EQ(map_.Overall(Car(1, -30.0, 0.0)), View::kOutOfView);
  EXPECT_EQ(map_.Overall(Car(1, -30.0, 0.1)), View::kOutOfView);
}

TEST_F(VisibilityMapTest, FollowsTheEgosPose) {
  map_.SetScene(Ego(0.0, {100.0, -50.0, FromDegrees(90.0)}), {});
  EXPECT_EQ(Front(Car(1, 100.0, 0.0)), View::kClear);
  EXPECT_EQ(Front(Car(1, 150.0, -50.0)), View::kOutOfView);
}

TEST_F(VisibilityMapTest, ACarBehindATruckIsOccluded) {
  Scene({Truck(7, 25.0, 0.0)});
  const auto behind = map_.From({SensorKind::kRadar, kFrontRadar}, Car(1, 45.0, 0.0));
  EXPECT_EQ(behind.view, View::kOccluded);
  EXPECT_LT(behind.uncovered, 0.2);
  EXPECT_EQ(map_.From({SensorKind::kCamera, 0}, Car(1, 45.0, 0.0)).view, View::kOccluded);
  EXPECT_EQ(map_.Overall(Car(1, 45.0, 0.0)), View::kOccluded);
}

TEST_F(VisibilityMapTest, BesideAndBeforeTheTruckIsClear) {
  Scene({Truck(7, 25.0, 0.0)});
  EXPECT_EQ(Front(Car(1, 45.0, 10.0)), View::kClear);
  EXPECT_EQ(Front(Car(1, 12.0, 0.0)), View::kClear);
  EXPECT_EQ(Front(Car(1, 25.0, 4.5)), View::kClear);
}

TEST_F(VisibilityMapTest, HalfHiddenIsUnknown) {
  Scene({Truck(7, 25.0, 0.0)});
  // The truck's left edge at 1.25 m and 15 m off throws its shadow to 3.4 m at 41 m.
  const auto half = map_.From({SensorKind::kRadar, kFrontRadar}, Car(1, 45.0, 3.0));
  EXPECT_EQ(half.view, View::kUnknown);
  EXPECT_GT(half.uncovered, 0.2);
  EXPECT_LT(half.uncovered, 0.8);
}

TEST_F(VisibilityMapTest, UncoveredGrowsSteadilyOutOfTheShadow) {
  Scene({Truck(7, 25.0, 0.0)});
  double last = -1.0;
  for (double y = 0.0; y <= 8.0; y += 0.1) {
    const double uncovered =
        map_.From({SensorKind::kRadar, kFrontRadar}, Car(1, 45.0, y)).uncovered;
    EXPECT_GE(uncovered, last - 0.02) << "y = " << y;
    last = uncovered;
  }
  EXPECT_NEAR(last, 1.0, 1e-9);
}

TEST_F(VisibilityMapTest, AnUncertainPlaceNearAShadowIsNotClear) {
  Scene({Truck(7, 25.0, 0.0)});
  Occluder sure = Car(1, 45.0, 7.0);
  EXPECT_EQ(Front(sure), View::kClear);
  Occluder unsure = sure;
  unsure.position_sigma_m = 2.0;
  EXPECT_EQ(Front(unsure), View::kUnknown);
  // Nor one whose 3 sigma leave the field of view or the range.
  Occluder far = Car(1, 150.0, -40.0);
  EXPECT_EQ(Front(far), View::kClear);
  far.position_sigma_m = 4.0;
  EXPECT_EQ(Front(far), View::kUnknown);
}

TEST_F(VisibilityMapTest, AVehicleNeverHidesItself) {
  Scene({Car(1, 40.0, 0.0), Truck(7, 60.0, 20.0)});
  EXPECT_EQ(Front(Car(1, 40.0, 0.0)), View::kClear);
  // Not even when the question does not know its number, or places it a little behind its track.
  EXPECT_EQ(Front(Car(0, 40.5, 0.2)), View::kClear);
  // A longer guess of its own extent: still itself.
  EXPECT_EQ(Front(Truck(1, 42.0, 0.0)), View::kClear);
}

TEST_F(VisibilityMapTest, FacadeHidesTheCrossRoadButNotTheStreetBeforeIt) {
  // A building's face across the view at x = 30 m, from y = 3 to 18 m, known by samples only.
  AccumulateWall({30.0, 3.0}, {30.0, 18.0});
  Scene({}, 1.0);
  const auto behind =
      map_.From({SensorKind::kRadar, kFrontRadar}, Car(1, 45.0, 12.0, FromDegrees(90.0)));
  EXPECT_EQ(behind.view, View::kOccluded);
  EXPECT_LT(behind.uncovered, 0.2);
  EXPECT_EQ(map_.From({SensorKind::kCamera, 0}, Car(1, 45.0, 12.0)).view, View::kOccluded);
  EXPECT_EQ(Front(Car(1, 20.0, 5.0)), View::kClear);
  EXPECT_EQ(Front(Car(1, 45.0, -5.0)), View::kClear);
  // Parked along the wall: its cells are not nearer than the car.
  EXPECT_EQ(Front(Car(1, 28.0, 8.0, FromDegrees(90.0))), View::kClear);
  // After the hold the wall is forgotten.
  Scene({}, 4.0);
  EXPECT_EQ(Front(Car(1, 45.0, 12.0)), View::kClear);
}

TEST_F(VisibilityMapTest, APoleMayHideButProvesNothing) {
  for (int scan = 0; scan < 10; ++scan) {
    map_.AccumulateStatic(At(0.05 * scan), Ego(), std::vector{Standing(20.0, 0.0)});
  }
  Scene({}, 0.5);
  const auto behind = map_.From({SensorKind::kRadar, kFrontRadar}, Car(1, 45.0, 0.0));
  EXPECT_EQ(behind.view, View::kUnknown);
  EXPECT_GE(behind.uncovered, 0.5);
}

TEST_F(VisibilityMapTest, AStoppedCarsOwnReturnsDoNotHideIt) {
  Random random(12);
  const Occluder stopped = Car(5, 35.0, -1.0);
  Scene({stopped});
  for (int scan = 0; scan < 40; ++scan) {
    std::vector<RadarMeasurement> returns;
    for (int i = 0; i < 3; ++i) {
      returns.push_back(
          Standing(32.75 + random.Normal(0.0, 0.3), -1.0 + random.Uniform(-1.0, 1.0)));
    }
    map_.AccumulateStatic(At(0.05 * scan), Ego(0.05 * scan), returns);
    Scene({stopped}, 0.05 * scan);
  }
  EXPECT_EQ(Front(stopped), View::kClear);
  // Before it had a track its returns did go into the raster; still they are not nearer than it.
  VisibilityMap untracked(VisibilityConfig{}, VehicleConfig{});
  for (int scan = 0; scan < 40; ++scan) {
    untracked.AccumulateStatic(
        At(0.05 * scan), Ego(0.05 * scan),
        std::vector{Standing(32.75, -1.0 + random.Uniform(-1.0, 1.0)), Standing(34.0, -0.2)});
  }
  untracked.SetScene(Ego(2.0), std::vector{stopped});
  EXPECT_EQ(untracked.From({SensorKind::kRadar, kFrontRadar}, stopped).view, View::kClear);
}

TEST_F(VisibilityMapTest, AWideFlatClusterStandsForTheWallBetweenItsReflections) {
  RadarMeasurement wall = Standing(30.0, 0.0);
  wall.azimuth_min_rad = FromDegrees(-7.0);
  wall.azimuth_max_rad = FromDegrees(7.0);
  wall.radial_extent_m = 0.5;
  for (int scan = 0; scan < 5; ++scan) {
    map_.AccumulateStatic(At(0.05 * scan), Ego(), std::vector{wall});
  }
  Scene({}, 0.3);
  EXPECT_EQ(Front(Car(1, 50.0, 3.0)), View::kOccluded);
  EXPECT_EQ(Front(Car(1, 50.0, 12.0)), View::kClear);
}

TEST_F(VisibilityMapTest, RadarsAndCameraDifferByWhereTheyLook) {
  Scene({});
  const Occluder side = Car(1, 10.0, 20.0);
  EXPECT_EQ(map_.From({SensorKind::kRadar, kLeftRadar}, side).view, View::kClear);
  EXPECT_EQ(map_.From({SensorKind::kRadar, 2}, side).view, View::kOutOfView);
  EXPECT_EQ(map_.From({SensorKind::kCamera, 0}, side).view, View::kOutOfView);
  EXPECT_EQ(map_.From({SensorKind::kCamera, 0}, Car(1, 130.0, 0.0)).view, View::kOutOfView);
  EXPECT_EQ(Front(Car(1, 130.0, 0.0)), View::kClear);
}

TEST_F(VisibilityMapTest, AtTheEdgeOfTheFieldOfViewNothingIsClear) {
  Scene({});
  const double edge = FromDegrees(30.0);
  const Occluder half_in = Car(1, 3.75 + 40.0 * std::cos(edge), 40.0 * std::sin(edge), 1.0);
  const auto seen = map_.From({SensorKind::kRadar, kFrontRadar}, half_in);
  EXPECT_EQ(seen.view, View::kUnknown);
  EXPECT_NEAR(seen.uncovered, 0.5, 0.2);
}

// A sensor that looks backwards: its azimuths cross the half circle's seam in O.
TEST(VisibilityMap, ARearSensorSeesAcrossTheSeam) {
  VehicleConfig vehicle;
  vehicle.radars.resize(1);
  vehicle.radars[0].x_m = -1.0;
  vehicle.radars[0].yaw_rad = kPi;
  VisibilityMap map({}, vehicle);
  map.SetScene(Ego(), std::vector{Truck(7, -25.0, 0.0)});
  EXPECT_EQ(map.From({SensorKind::kRadar, 0}, Car(1, -45.0, 0.0)).view, View::kOccluded);
  EXPECT_EQ(map.From({SensorKind::kRadar, 0}, Car(1, -45.0, 15.0)).view, View::kClear);
  EXPECT_EQ(map.From({SensorKind::kRadar, 0}, Car(1, -45.0, -15.0)).view, View::kClear);
  EXPECT_EQ(map.From({SensorKind::kRadar, 0}, Car(1, 45.0, 0.0)).view, View::kOutOfView);
}

// Property: a fully random scene never makes a query fail, and shares stay shares.
TEST(VisibilityMapProperty, AnswersStayInTheirRange) {
  Random random(31);
  for (int trial = 0; trial < 300; ++trial) {
    VisibilityMap map({}, {});
    std::vector<Occluder> boxes;
    for (int i = 0; i < 40; ++i) {
      boxes.push_back({.id = static_cast<std::uint64_t>(i),
                       .centre_O = {random.Uniform(-80.0, 80.0), random.Uniform(-80.0, 80.0)},
                       .yaw_rad = random.Uniform(-4.0, 4.0),
                       .length_m = random.Uniform(0.0, 18.0),
                       .width_m = random.Uniform(0.0, 3.0),
                       .position_sigma_m = trial % 5 == 0 ? 0.0 : random.Uniform(0.0, 20.0)});
    }
    map.SetScene(Ego(0.0, {random.Uniform(-5.0, 5.0), 0.0, random.Uniform(-4.0, 4.0)}), boxes);
    for (const Occluder& box : boxes) {
      for (int radar = 0; radar < 3; ++radar) {
        const SensorView seen = map.From({SensorKind::kRadar, radar}, box);
        ASSERT_GE(seen.uncovered, 0.0);
        ASSERT_LE(seen.uncovered, 1.0 + 1e-12);
        ASSERT_TRUE(seen.view != View::kClear || seen.uncovered > 0.5);
      }
      const View overall = map.Overall(box);
      ASSERT_TRUE(map.From({SensorKind::kCamera, 0}, box).view != View::kClear ||
                  overall == View::kClear);
    }
  }
}

TEST(VisibilityMap, ACopyIsACheckpointAndSmall) {
  VisibilityMap map({}, {});
  const std::vector<Occluder> boxes(50, Truck(7, 25.0, 0.0));
  map.SetScene(Ego(), boxes);
  const VisibilityMap copy = map;
  map.SetScene(Ego(1.0), {});
  EXPECT_EQ(copy.From({SensorKind::kRadar, 0}, Car(1, 45.0, 0.0)).view, View::kOccluded);
  EXPECT_EQ(map.From({SensorKind::kRadar, 0}, Car(1, 45.0, 0.0)).view, View::kClear);
  EXPECT_LE(sizeof(VisibilityMap), 13'000U);  // The raster; sensors, bins and boxes add 4 kB.
}

}  // namespace
}  // namespace v2vouch
