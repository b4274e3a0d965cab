// SPDX-License-Identifier: Apache-2.0
// What radars and cameras show and is no vehicle, or none of its own: it is not listed, and real
// ones beside it are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "daemon/common/base/angle.h"
#include "tests/daemon/local/tracking/scene.h"

namespace v2vouch {
namespace {

using Extra = std::function<void(std::vector<RadarMeasurement>&)>;

// One scan of the scene with what `extra` does to it.
void Scan(Scene& scene, Tracker& tracker, const Extra& extra) {
  auto scan = scene.Scan(0);
  extra(scan);
  scene.Radar(tracker, scan);
}

// What a radar alone makes of the scene in five seconds.
Tracker AfterFiveSeconds(Scene& scene) {
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  for (int step = 0; step < 100; ++step) {
    scene.Advance(0.05);
    scene.Radar(tracker);
  }
  return tracker;
}

RadarMeasurement Return(const Scene& scene, double range_m, double azimuth_rad, double ground_mps,
                        double strength_db) {
  const RadarConfig& radar = scene.vehicle.radars[0];
  RadarMeasurement z;
  z.range_m = z.near_range_m = range_m;
  z.azimuth_rad = z.azimuth_min_rad = z.azimuth_max_rad = z.middle_azimuth_rad = azimuth_rad;
  z.ground_range_rate_mps = ground_mps;
  z.range_rate_mps = ground_mps - scene.ego.speed_mps * std::cos(azimuth_rad);
  z.is_static = std::abs(ground_mps) < 0.6;
  z.covariance =
      Eigen::Vector3d(std::pow(radar.range_sigma_m, 2), std::pow(radar.azimuth_sigma_rad, 2),
                      std::pow(radar.range_rate_sigma_mps, 2))
          .asDiagonal();
  z.outline[z.outline_count++] = {range_m, azimuth_rad, strength_db};
  return z;
}

TEST(Phantom, RainIsNotListedAndACarInItIs) {
  Scene scene(3);
  scene.ego.speed_mps = 10.0;
  scene.cars = {{.p_W = {24.0, 3.5}, .speed_mps = 12.0}};
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  Random random(5);
  int lists = 0, phantoms = 0, found = 0;
  for (int step = 0; step < 400; ++step) {
    scene.Advance(0.05);
    if (scene.cars[0].p_W.x() > scene.ego.p_W.x() + 60.0) scene.cars[0].speed_mps = 8.0;
    Scan(scene, tracker, [&](auto& scan) {
      for (int drop = random.Poisson(8.0); drop > 0; --drop) {
        scan.push_back(Return(scene, random.Uniform(1.0, 25.0), random.Uniform(-1.04, 1.04),
                              random.Normal(0.0, 1.5), 3.0));
      }
    });
    if (step < 40) continue;
    ++lists;
    const bool is_found = Scene::Find(tracker, scene.cars[0]) != nullptr;
    found += is_found ? 1 : 0;
    phantoms += Scene::Confirmed(tracker) - (is_found ? 1 : 0);
  }
  EXPECT_EQ(found, lists);
  EXPECT_LT(phantoms, 0.1 * lists);  // 5.4 a list where the clutter is what the radar promises.
}

TEST(Phantom, WhatHasMovedNowhereIsNotKeptByAWall) {
  // Moving foliage before a wall: Doppler for a moment, then only the wall.
  Scene scene(4);
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  Random random(6);
  int listed_late = 0;
  for (int step = 0; step < 200; ++step) {
    scene.Advance(0.05);
    Scan(scene, tracker, [&](auto& scan) {
      const double rate = step < 30 ? random.Uniform(0.8, 1.5) : 0.0;
      scan.push_back(Return(scene, 20.0 + random.Normal(0.0, 0.2), 0.3, rate, 20.0));
    });
    if (step > 60) listed_late += Scene::Confirmed(tracker);
  }
  EXPECT_EQ(listed_late, 0);
}

TEST(Phantom, AnEchoFromTheCornerOfTheCarAheadIsNotListed) {
  // The second trip to a car's tail: twice the range and range rate, 20 dB weaker, from either
  // corner; its bearing is far beside the middle of the tail.
  Scene scene(7);
  scene.ego.speed_mps = 9.0;
  scene.cars = {{.p_W = {21.0, 0.0}, .speed_mps = 9.3}};
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  int phantoms = 0;
  for (int step = 0; step < 120; ++step) {
    scene.Advance(0.05);
    Scan(scene, tracker, [&](auto& scan) {
      if (scan.empty()) return;
      RadarMeasurement& tail = scan[0];
      for (std::size_t k = 0; k < tail.outline_count; ++k) tail.outline[k].strength_db = 50.0;
      if (step % 3 == 0) return;
      const double corner_rad = (step % 2 == 0 ? 0.9 : -0.9) / tail.range_m;
      RadarMeasurement echo =
          Return(scene, 2.0 * tail.range_m, corner_rad, 9.0 + 2.0 * tail.range_rate_mps, 30.0);
      echo.range_rate_mps = 2.0 * tail.range_rate_mps;
      scan.push_back(echo);
    });
    if (step > 10) phantoms += Scene::Confirmed(tracker) - 1;
  }
  EXPECT_EQ(phantoms, 0);
}

TEST(Phantom, ACarAtTwiceTheRangeIsNoEcho) {
  Scene scene(7);
  scene.ego.speed_mps = 9.0;
  scene.cars = {{.p_W = {21.0, 0.0}, .speed_mps = 9.0}, {.p_W = {40.0, 0.0}, .speed_mps = 9.0}};
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  int lists = 0, found = 0;
  for (int step = 0; step < 120; ++step) {
    scene.Advance(0.05);
    Scan(scene, tracker, [&](auto& scan) {
      for (RadarMeasurement& z : scan) {  // By the fourth power of the range.
        const double db = 55.0 - 40.0 * std::log10(z.range_m / 16.0);
        for (std::size_t k = 0; k < z.outline_count; ++k) z.outline[k].strength_db = db;
      }
    });
    if (step < 20) continue;
    ++lists;
    found += Scene::Find(tracker, scene.cars[1]) != nullptr ? 1 : 0;
  }
  EXPECT_EQ(found, lists);
}

TEST(Phantom, WhatReflectsAtAMovingLorrysEndIsNoCarOfItsOwn) {
  Scene scene(8);
  scene.ego.speed_mps = 22.0;
  scene.cars = {{.p_W = {30.0, 0.0},
                 .speed_mps = 22.0,
                 .length_m = 9.0,
                 .width_m = 2.5,
                 .object_class = ObjectClass::kTruck}};
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  int seconds = 0;
  for (int step = 0; step < 160; ++step) {
    scene.Advance(0.05);
    // A licence plate's arm 1.2 m behind its tail.
    Scan(scene, tracker, [&](auto& scan) {
      if (step < 40) return;
      const double range_m = scene.cars[0].p_W.x() - 4.5 - 1.2 - scene.ego.p_W.x() - 3.7;
      if (step % 2 == 0) scan.push_back(Return(scene, range_m, 0.5 / range_m, 22.0, 10.0));
    });
    if (step % 2 == 1) scene.Camera(tracker);
    seconds += std::max(0, Scene::Confirmed(tracker) - 1);
  }
  EXPECT_NE(Scene::Find(tracker, scene.cars[0]), nullptr);
  EXPECT_EQ(seconds, 0);
}

TEST(Phantom, TwoReflectorsCloserThanAnybodyDrivesAreOneLongVehicle) {
  // An articulated lorry that shows a radar its tail and its front axle, and no camera.
  Scene scene(9);
  scene.ego.speed_mps = 24.0;
  scene.cars = {{.p_W = {50.0, 0.0}, .speed_mps = 24.0}, {.p_W = {60.5, 0.0}, .speed_mps = 24.0}};
  const Tracker tracker = AfterFiveSeconds(scene);
  ASSERT_EQ(Scene::Confirmed(tracker), 1);
  const LocalTrack* lorry = Scene::Find(tracker, scene.cars[0], 8.0);
  ASSERT_NE(lorry, nullptr);
  EXPECT_NEAR(lorry->extent.length_m, 13.0, 3.5);
}

TEST(Phantom, CarsThatFollowAtOneSecondStayTwo) {
  Scene scene(9);
  scene.ego.speed_mps = 24.0;
  scene.cars = {{.p_W = {50.0, 0.0}, .speed_mps = 24.0}, {.p_W = {78.0, 0.0}, .speed_mps = 24.0}};
  const Tracker tracker = AfterFiveSeconds(scene);
  EXPECT_EQ(Scene::Confirmed(tracker), 2);
}

TEST(Phantom, AQueueThatStandsCloseIsNoLorry) {
  Scene scene(9);
  scene.ego.speed_mps = 3.0;
  scene.cars = {{.p_W = {20.0, 0.0}, .speed_mps = 3.0}, {.p_W = {27.0, 0.0}, .speed_mps = 3.0}};
  const Tracker tracker = AfterFiveSeconds(scene);
  EXPECT_EQ(Scene::Confirmed(tracker), 2);
}

TEST(Phantom, APictureOfWhatAClearRadarSeesNothingOfIsNotListed) {
  // A detector's false box stands in the lane ahead; the radar looks there and nothing reflects.
  Scene scene(10);
  scene.standing = 3;
  scene.cars = {{.p_W = {28.0, 0.0}}};
  for (const bool is_real : {false, true}) {
    Tracker tracker(TrackerConfig{}, scene.vehicle);
    int listed = 0;
    for (int step = 0; step < 80; ++step) {
      scene.Advance(0.05);
      scene.cars[0].is_absent = !is_real;
      scene.Radar(tracker);
      scene.cars[0].is_absent = false;
      scene.Camera(tracker);
      if (step >= 20) listed += Scene::Confirmed(tracker);
    }
    EXPECT_EQ(listed, is_real ? 60 : 0);
  }
}

TEST(Phantom, AStandingCarThatRadarsStillSeeOutlivesACamerasBadSecond) {
  Scene scene(11);
  scene.cars = {{.p_W = {25.0, 3.0}}};
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  for (int step = 0; step < 60; ++step) {
    scene.Advance(0.05);
    scene.Radar(tracker);
    scene.Camera(tracker);
  }
  ASSERT_NE(Scene::Find(tracker, scene.cars[0]), nullptr);
  for (int step = 0; step < 24; ++step) {  // 1.2 s.
    scene.Advance(0.05);
    scene.Radar(tracker);
    scene.cars[0].is_absent = true;  // Visibility says that it should be seen.
    scene.Camera(tracker);
    scene.cars[0].is_absent = false;
    EXPECT_NE(Scene::Find(tracker, scene.cars[0]), nullptr) << step;
  }
  // Neither sees it any more: it has left.
  scene.cars[0].is_absent = true;
  for (int step = 0; step < 20; ++step) {
    scene.Advance(0.05);
    scene.Radar(tracker);
    scene.Camera(tracker);
  }
  EXPECT_EQ(Scene::Confirmed(tracker), 0);
}

}  // namespace
}  // namespace v2vouch
