// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/tracker.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "daemon/common/base/angle.h"
#include "tests/daemon/local/tracking/scene.h"

namespace v2vouch {
namespace {

// What a run of a scene gave, sampled after every scan.
struct Score {
  double rms_m = 0.0;
  int missed = 0;
  int false_tracks = 0;
  int switches = 0;
  double worst_yaw_rad = 0.0;
};

// Runs `steps` scans at 20 Hz and a picture every second scan; scores after `warm_up` scans.
template <class Before>
Score Drive(Scene& scene, Tracker& tracker, int steps, int warm_up, bool with_camera,
            Before&& before) {
  Score score;
  double squares = 0.0;
  int count = 0;
  std::vector<std::uint64_t> ids(scene.cars.size(), 0);
  for (int step = 0; step < steps; ++step) {
    before(step);
    scene.Advance(0.05);
    scene.Radar(tracker);
    if (with_camera && step % 2 == 1) scene.Camera(tracker);
    EXPECT_TRUE(tracker.failures().empty());
    if (step < warm_up) continue;
    int found = 0;
    for (std::size_t i = 0; i < scene.cars.size(); ++i) {
      const LocalTrack* track = Scene::Find(tracker, scene.cars[i]);
      if (track == nullptr) {
        ++score.missed;
        continue;
      }
      ++found;
      if (ids[i] != 0 && ids[i] != track->id) ++score.switches;
      ids[i] = track->id;
      squares += (track->state_O.mean.head<2>() - scene.cars[i].p_W).squaredNorm();
      score.worst_yaw_rad =
          std::max(score.worst_yaw_rad,
                   std::abs(WrapAngle(track->state_O.mean[kYaw] - scene.cars[i].yaw_rad)));
      ++count;
    }
    score.false_tracks += std::max(0, Scene::Confirmed(tracker) - found);
  }
  score.rms_m = std::sqrt(squares / std::max(count, 1));
  return score;
}

TEST(Tracker, CrossingCarsAreTrackedThoughTheirDopplerVanishes) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    Scene scene(seed);
    scene.clutter = 0.5;
    scene.cars.push_back({.p_W = {30.0, -22.0}, .yaw_rad = 0.5 * kPi, .speed_mps = 9.0});
    scene.cars.push_back({.p_W = {45.0, 34.0}, .yaw_rad = -0.5 * kPi, .speed_mps = 13.0});
    Tracker tracker(TrackerConfig{}, scene.vehicle);
    const Score score = Drive(scene, tracker, 90, 20, false, [](int) {});
    EXPECT_LT(score.rms_m, 0.6) << seed;
    EXPECT_EQ(score.missed, 0) << seed;
    EXPECT_EQ(score.switches, 0) << seed;
    EXPECT_EQ(score.false_tracks, 0) << seed;
    EXPECT_LT(score.worst_yaw_rad, 0.4) << seed;
  }
}

TEST(Tracker, ConfirmsOnTheThirdLookAndNeverFromClutter) {
  Scene scene(7);
  scene.clutter = 1.0;
  scene.standing = 12;
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  int confirmed = 0;
  for (int step = 0; step < 2000; ++step) {
    scene.Advance(0.05);
    scene.Radar(tracker);
    confirmed += Scene::Confirmed(tracker);
  }
  EXPECT_EQ(confirmed, 0) << "100 s of clutter and poles";
  scene.detection_probability = 0.999;
  scene.cars.push_back({.p_W = {60.0, 2.0}, .yaw_rad = kPi, .speed_mps = 12.0});
  for (int look = 1; look <= 4; ++look) {
    scene.Advance(0.05);
    scene.Radar(tracker);
    EXPECT_EQ(Scene::Confirmed(tracker), look >= 3 ? 1 : 0) << "look " << look;
  }
}

TEST(Tracker, VisibleButMissingFallsHiddenIsHeld) {
  for (const bool is_hidden : {true, false}) {
    Scene scene(8);
    scene.cars.push_back({.p_W = {50.0, 3.5}, .yaw_rad = kPi, .speed_mps = 8.0});
    Tracker tracker(TrackerConfig{}, scene.vehicle);
    Drive(scene, tracker, 40, 40, true, [](int) {});
    ASSERT_EQ(Scene::Confirmed(tracker), 1);
    (is_hidden ? scene.cars[0].is_hidden : scene.cars[0].is_absent) = true;
    for (int step = 0; step < 40; ++step) {  // 2 s
      scene.Advance(0.05);
      scene.Radar(tracker);
    }
    EXPECT_EQ(Scene::Confirmed(tracker), is_hidden ? 1 : 0);
    if (is_hidden) {
      EXPECT_EQ(tracker.tracks()[0].visibility, Visibility::kHidden);
      EXPECT_GT(tracker.tracks()[0].existence, 0.9);
      // Not for ever.
      for (int step = 0; step < 50; ++step) {
        scene.Advance(0.05);
        scene.Radar(tracker);
      }
      EXPECT_EQ(Scene::Confirmed(tracker), 0);
    }
  }
}

// An echo that shows in one scan of five, where radar and camera both see clearly, is no vehicle: a
// hit is no independent proof of what reflected before.
TEST(Tracker, WhatShowsInAFifthOfTheFramesIsListedNoLonger) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    Scene scene(seed);
    scene.detection_probability = 1.0;
    scene.cars.push_back({.p_W = {30.0, 0.0}, .speed_mps = 10.0});
    scene.ego.speed_mps = 10.0;
    Tracker tracker(TrackerConfig{}, scene.vehicle);
    Drive(scene, tracker, 40, 40, true, [](int) {});
    ASSERT_EQ(Scene::Confirmed(tracker), 1);
    for (int step = 0; step < 30; ++step) {  // 1.5 s
      scene.Advance(0.05);
      scene.cars[0].is_absent = step % 5 != 0;
      scene.Radar(tracker);
      scene.cars[0].is_absent = true;
      if (step % 2 == 1) scene.Camera(tracker);
    }
    EXPECT_EQ(Scene::Confirmed(tracker), 0) << "seed " << seed;
  }
}

TEST(Tracker, CarThatStopsIsKeptByStandingClustersAndKeepsItsYaw) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Scene scene(seed);
    scene.standing = 10;
    scene.cars.push_back({.p_W = {20.0, 3.0}, .yaw_rad = 0.1, .speed_mps = 10.0});
    Tracker tracker(TrackerConfig{}, scene.vehicle);
    const auto drive = [&scene](int step) {
      Car& car = scene.cars[0];
      car.accel_mps2 = step >= 60 && car.speed_mps > 0.0 ? -3.0 : 0.0;
      if (step > 60 && car.speed_mps <= 0.15) car.speed_mps = car.accel_mps2 = 0.0;
    };
    // 20 s of standing after the stop, radar alone.
    const Score score = Drive(scene, tracker, 530, 20, false, drive);
    EXPECT_EQ(score.missed, 0) << seed;
    EXPECT_EQ(score.switches, 0) << seed;
    EXPECT_EQ(score.false_tracks, 0) << seed;
    EXPECT_LT(score.worst_yaw_rad, 0.35) << seed;
    EXPECT_LT(score.rms_m, 0.7) << seed;
    const LocalTrack* track = Scene::Find(tracker, scene.cars[0]);
    ASSERT_NE(track, nullptr);
    EXPECT_LT(std::abs(track->state_O.mean[kSpeed]), 0.2);
  }
}

TEST(Tracker, StandingClustersAloneStartNothingACameraBoxDoes) {
  Scene scene(9);
  scene.standing = 10;
  scene.cars.push_back({.p_W = {28.0, 0.5}});
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  Drive(scene, tracker, 60, 0, false, [&](int) { EXPECT_TRUE(tracker.tracks().empty()); });
  const Score score = Drive(scene, tracker, 100, 20, true, [](int) {});
  EXPECT_EQ(score.missed, 0);
  EXPECT_EQ(score.false_tracks, 0);
  EXPECT_LT(score.rms_m, 1.0);
  // The radar keeps alive what the camera named.
  const Score alone = Drive(scene, tracker, 200, 0, false, [](int) {});
  EXPECT_EQ(alone.missed, 0);
}

TEST(Tracker, ABoxBeyondSixtyMetresStartsNothing) {
  Scene scene(10);
  scene.cars.push_back({.p_W = {95.0, 0.5}, .speed_mps = 0.0});
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  for (int step = 0; step < 50; ++step) {
    scene.Advance(0.1);
    scene.Camera(tracker);
    EXPECT_EQ(Scene::Confirmed(tracker), 0);
  }
}

TEST(Tracker, SeveralClustersOfOneTruckAreOneTrack) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Scene scene(seed);
    scene.split = 3;
    scene.cars.push_back({.p_W = {40.0, 6.0},
                          .yaw_rad = kPi,
                          .speed_mps = 8.0,
                          .length_m = 11.0,
                          .width_m = 2.5,
                          .object_class = ObjectClass::kTruck});
    Tracker tracker(TrackerConfig{}, scene.vehicle);
    const Score score = Drive(scene, tracker, 70, 15, true, [](int) {});
    EXPECT_EQ(score.missed, 0) << seed;
    // A second track may live for a third of a second while the lorry's size is being learned.
    EXPECT_LE(score.false_tracks, 7) << seed;
    EXPECT_LE(score.switches, 2) << seed;
    EXPECT_LT(score.rms_m, 1.5) << seed;
    const LocalTrack* track = Scene::Find(tracker, scene.cars[0]);
    ASSERT_NE(track, nullptr);
    EXPECT_EQ(track->object_class, ObjectClass::kTruck);
    EXPECT_NEAR(track->extent.length_m, 11.0, 3.0);
  }
}

TEST(Tracker, OncomingCarsThatPassCloseTogetherKeepTheirIdentities) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Scene scene(seed);
    scene.clutter = 0.5;
    scene.ego.speed_mps = 10.0;
    for (int i = 0; i < 4; ++i) {
      scene.cars.push_back({.p_W = {20.0 + 12.0 * i, 0.0}, .speed_mps = 12.0});
      scene.cars.push_back({.p_W = {95.0 + 12.0 * i, 3.5}, .yaw_rad = kPi, .speed_mps = 11.0});
    }
    Tracker tracker(TrackerConfig{}, scene.vehicle);
    std::vector<std::uint64_t> ids(8, 0);
    int switches = 0, strangers = 0;
    for (int step = 0; step < 100; ++step) {
      scene.Advance(0.05);
      scene.Radar(tracker);
      if (step % 2 == 1) scene.Camera(tracker);
      int found = 0;
      for (std::size_t i = 0; i < 8; ++i) {
        const LocalTrack* track = Scene::Find(tracker, scene.cars[i], 2.0);
        if (track == nullptr) continue;
        ++found;
        if (ids[i] != 0 && ids[i] != track->id) ++switches;
        ids[i] = track->id;
      }
      if (step > 20) strangers += Scene::Confirmed(tracker) - found;
    }
    EXPECT_EQ(switches, 0) << seed;
    EXPECT_LE(strangers, 4) << seed;
  }
}

TEST(Tracker, TurningCarIsFollowedThroughTheTurn) {
  Scene scene(12);
  scene.cars.push_back({.p_W = {45.0, 3.0}, .yaw_rad = kPi, .speed_mps = 9.0});
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  // A left turn of 90 degrees in 3 s after 1.5 s straight.
  const Score score = Drive(scene, tracker, 90, 15, true, [&](int step) {
    scene.cars[0].yaw_rate_radps = step >= 30 && step < 90 ? 0.5 * kPi / 3.0 : 0.0;
  });
  EXPECT_EQ(score.missed, 0);
  EXPECT_EQ(score.switches, 0);
  EXPECT_LT(score.rms_m, 0.55);
  EXPECT_LT(score.worst_yaw_rad, 0.4);
}

TEST(Tracker, ReversingCarKeepsItsHeading) {
  Scene scene(13);
  scene.cars.push_back({.p_W = {25.0, 2.0}, .speed_mps = 6.0});
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  const Score score = Drive(scene, tracker, 240, 20, true, [&](int step) {
    Car& car = scene.cars[0];
    car.accel_mps2 = step >= 40 && car.speed_mps > -3.0 ? -2.0 : 0.0;
  });
  EXPECT_EQ(score.switches, 0);
  EXPECT_EQ(score.missed, 0);
  EXPECT_LT(score.worst_yaw_rad, 0.4);
  const LocalTrack* track = Scene::Find(tracker, scene.cars[0]);
  ASSERT_NE(track, nullptr);
  EXPECT_LT(track->state_O.mean[kSpeed], -2.0);
}

// Turning the whole world changes no decision, and turns every state.
TEST(TrackerProperty, TrafficTurnedByAnyAngleGivesTheSameTracks) {
  for (const double angle : {0.3, 1.0, 2.0, kPi, -2.5}) {
    Scene straight(14), turned(14);
    const Eigen::Rotation2D<double> R(angle);
    for (Scene* scene : {&straight, &turned}) {
      scene->clutter = 0.5;
      scene->ego.speed_mps = 8.0;
      scene->ego.yaw_rate_radps = 0.05;
      for (int i = 0; i < 4; ++i) {
        scene->cars.push_back({.p_W = {20.0 + 9.0 * i, -3.0 + 2.5 * i},
                               .yaw_rad = i % 2 == 0 ? 0.0 : kPi,
                               .speed_mps = 6.0 + i});
      }
    }
    turned.ego.yaw_rad += angle;
    for (Car& car : turned.cars) {
      car.p_W = R * car.p_W;
      car.yaw_rad += angle;
    }
    Tracker a(TrackerConfig{}, straight.vehicle), b(TrackerConfig{}, turned.vehicle);
    for (int step = 0; step < 80; ++step) {
      for (auto [scene, tracker] : {std::pair{&straight, &a}, std::pair{&turned, &b}}) {
        scene->Advance(0.05);
        scene->Radar(*tracker);
        if (step % 2 == 1) scene->Camera(*tracker);
      }
      ASSERT_EQ(a.tracks().size(), b.tracks().size()) << "step " << step << " angle " << angle;
      for (std::size_t i = 0; i < a.tracks().size(); ++i) {
        const LocalTrack& p = a.tracks()[i];
        const LocalTrack& q = b.tracks()[i];
        ASSERT_EQ(p.id, q.id);
        ASSERT_EQ(p.is_confirmed, q.is_confirmed);
        EXPECT_LT((R * p.state_O.mean.head<2>() - q.state_O.mean.head<2>()).norm(), 1e-6);
        EXPECT_NEAR(WrapAngle(q.state_O.mean[kYaw] - p.state_O.mean[kYaw] - angle), 0.0, 1e-6);
        EXPECT_NEAR(p.state_O.mean[kSpeed], q.state_O.mean[kSpeed], 1e-6);
        EXPECT_NEAR(p.existence, q.existence, 1e-6);
      }
    }
  }
}

TEST(Tracker, ACopyIsACheckpoint) {
  Scene scene(15);
  scene.clutter = 1.0;
  for (int i = 0; i < 5; ++i)
    scene.cars.push_back({.p_W = {20.0 + 10.0 * i, 2.0}, .speed_mps = 7.0});
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  Drive(scene, tracker, 40, 40, true, [](int) {});
  Tracker copy = tracker;
  Scene other = scene;
  Drive(scene, tracker, 20, 20, true, [](int) {});
  Drive(other, copy, 20, 20, true, [](int) {});
  ASSERT_EQ(tracker.tracks().size(), copy.tracks().size());
  for (std::size_t i = 0; i < copy.tracks().size(); ++i) {
    EXPECT_EQ(tracker.tracks()[i].id, copy.tracks()[i].id);
    EXPECT_EQ(tracker.tracks()[i].state_O.mean, copy.tracks()[i].state_O.mean);
    EXPECT_EQ(tracker.tracks()[i].existence, copy.tracks()[i].existence);
  }
}

// 32 radars, 32 cameras and 32 sources of objects that all see another car at one instant.
TEST(Tracker, AsManySensorsAsCanBeConfiguredGiveDistinctTracksAndAreAskedByTheirKind) {
  VehicleConfig vehicle;
  vehicle.radars.assign(32, VehicleConfig::DefaultRadars()[0]);
  vehicle.cameras.assign(32, CameraConfig{});
  vehicle.objects.assign(32, ObjectSensorConfig{});
  TrackerConfig config;
  Tracker tracker(config, vehicle);
  EgoState ego;
  ego.stamp = FromMicros(1'700'000'000'000'000);
  const auto visible = [](const LocalTrack&) { return Detectability{0.0, Visibility::kVisible}; };
  for (int i = 0; i < 32; ++i) {
    tracker.Predict(ego.stamp);
    RadarMeasurement radar{.radar = i, .range_m = 20.0 + 4.0 * i, .range_rate_mps = 5.0};
    radar.covariance = Eigen::Vector3d(0.01, 1e-5, 0.01).asDiagonal();
    radar.azimuth_rad = FromDegrees(-25.0);
    radar.ground_range_rate_mps = 5.0;
    tracker.UpdateRadar(i, ego, std::vector{radar}, visible);
  }
  for (int i = 0; i < 32; ++i) {
    tracker.Predict(ego.stamp);
    const double depression_rad = std::atan2(1.4, 15.0 + 1.2 * i);
    CameraMeasurement camera{.camera = i,
                             .azimuth_left_rad = FromDegrees(-3.0 + 2.0 * (i % 9)),
                             .azimuth_right_rad = FromDegrees(-4.5 + 2.0 * (i % 9)),
                             .depression_rad = depression_rad,
                             .azimuth_sigma_rad = 1e-3,
                             .depression_sigma_rad = 1e-3,
                             .score = 0.9};
    tracker.UpdateCamera(i, ego, std::vector{camera}, visible);
  }
  for (int i = 0; i < 32; ++i) {
    tracker.Predict(ego.stamp);
    const std::vector boxes = {BoxMeasurement{.x_m = -20.0 - 8.0 * i, .y_m = 10.0, .sensor = i}};
    tracker.UpdateObjects(i, ego, boxes, visible);
  }
  std::set<std::uint64_t> ids;
  std::array<int, kSensorKinds> started{};
  for (const LocalTrack& track : tracker.tracks()) {
    ids.insert(track.id);
    ++started[static_cast<std::size_t>(track.support.sources()[0].sensor.kind)];
  }
  EXPECT_EQ(ids.size(), tracker.tracks().size());
  EXPECT_EQ(started[0], 32);
  EXPECT_GE(started[1], 20) << "some boxes show one place";
  EXPECT_EQ(started[2], 32);
}

// A sensor's last frame is its own: had another one's been taken for it, the miss would count for
// hardly anything (TrackerConfig::miss_memory_s).
TEST(Tracker, AMissOfOneSensorCountsInFullWhateverAnotherOfTheSameNumberDid) {
  VehicleConfig vehicle;
  vehicle.radars.assign(20, VehicleConfig::DefaultRadars()[0]);
  vehicle.objects.assign(20, ObjectSensorConfig{});
  const auto existence_after = [&](int other) {
    Tracker tracker(TrackerConfig{}, vehicle);
    EgoState ego;
    ego.stamp = FromMicros(1'700'000'000'000'000);
    const auto visible = [](const LocalTrack&) { return Detectability{0.9, Visibility::kVisible}; };
    for (int k = 0; k < 30; ++k) {
      ego.stamp += FromSeconds(0.1);
      tracker.Predict(ego.stamp);
      tracker.UpdateObjects(0, ego, std::vector{BoxMeasurement{.x_m = 20.0}}, visible);
    }
    ego.stamp += FromSeconds(0.2);
    tracker.Predict(ego.stamp);
    const auto nothing = [](const LocalTrack&) { return Detectability{}; };
    if (other >= 0) tracker.UpdateRadar(other, ego, {}, nothing);
    ego.stamp += FromSeconds(0.001);
    tracker.Predict(ego.stamp);
    tracker.UpdateRadar(3, ego, {}, visible);
    return tracker.tracks().empty() ? 0.0 : tracker.tracks()[0].existence;
  };
  EXPECT_DOUBLE_EQ(existence_after(19), existence_after(-1));  // 19 = 3 modulo 16.
  EXPECT_GT(existence_after(3), existence_after(-1));
}

TEST(Tracker, MeasurementsThatAreNotFiniteAreSkippedAndAFullTableIsReported) {
  Scene scene(16);
  for (int i = 0; i < 5; ++i) {
    scene.cars.push_back({.p_W = {20.0 + 12.0 * i, 2.0}, .speed_mps = 7.0});
  }
  scene.detection_probability = 0.999;
  TrackerConfig config;
  config.max_tracks = 2;
  Tracker tracker(config, scene.vehicle);
  scene.Advance(0.05);
  auto scan = scene.Scan(0);
  scan[0].range_m = kNaN;
  scan[1].covariance(0, 0) = std::numeric_limits<double>::infinity();
  tracker.Predict(scene.now());
  tracker.UpdateRadar(0, scene.ego_state(), scan, [](const LocalTrack&) {
    return Detectability{0.9, Visibility::kVisible};
  });
  EXPECT_EQ(tracker.tracks().size(), 2U);
  for (const LocalTrack& track : tracker.tracks()) EXPECT_TRUE(track.state_O.mean.allFinite());
  ASSERT_EQ(tracker.failures().size(), 1U);
  EXPECT_EQ(tracker.failures()[0], Reason::kTrackTableFull);
}

}  // namespace
}  // namespace v2vouch
