// SPDX-License-Identifier: Apache-2.0
// A class name is evidence, not a size: what a camera calls a vehicle wrongly, now and then or all
// the time, neither ends its track nor pins its length.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "daemon/common/base/angle.h"
#include "tests/daemon/local/tracking/scene.h"

namespace v2vouch {
namespace {

constexpr double kStep_s = 0.05;

struct Seen {
  int judged = 0;
  int missed = 0;         ///< Lists after 1.5 s without the vehicle.
  int false_tracks = 0;   ///< In the same lists.
  double sum = 0.0;       ///< Of squared position errors.
  double length_m = 0.0;  ///< At the end.
  double length_sigma_m = 0.0;
  [[nodiscard]] double rms_m() const { return judged > 0 ? std::sqrt(sum / judged) : 0.0; }
};

using Name = std::function<ObjectClass(int picture)>;

Seen Watch(const Car& car, double ego_speed_mps, double duration_s, std::uint64_t seed,
           const Name& name) {
  Scene scene(seed);
  scene.ego.speed_mps = ego_speed_mps;
  scene.split = car.length_m > 7.0 ? 2 : 1;
  scene.cars.push_back(car);
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  Seen seen;
  int picture = 0;
  for (int step = 0; kStep_s * step < duration_s; ++step) {
    scene.Advance(kStep_s);
    scene.Radar(tracker);
    if (step % 2 == 1) {
      scene.cars[0].object_class = name(picture++);
      scene.Camera(tracker);
    }
    if (kStep_s * step < 1.5) continue;
    const Car& truth = scene.cars[0];
    const LocalTrack* best = nullptr;
    for (const LocalTrack& track : tracker.tracks()) {
      if (!track.is_confirmed) continue;
      const double off_m = (track.state_O.mean.head<2>() - truth.p_W).norm();
      if (off_m < 2.0 + 0.5 * truth.length_m &&
          (best == nullptr || off_m < (best->state_O.mean.head<2>() - truth.p_W).norm())) {
        best = &track;
      }
    }
    seen.false_tracks += Scene::Confirmed(tracker) - (best != nullptr ? 1 : 0);
    if (best == nullptr) {
      ++seen.missed;
      continue;
    }
    ++seen.judged;
    seen.sum += (best->state_O.mean.head<2>() - truth.p_W).squaredNorm();
    seen.length_m = best->extent.length_m;
    seen.length_sigma_m = best->extent.length_sigma_m;
  }
  return seen;
}

Name Always(ObjectClass object_class) {
  return [=](int) { return object_class; };
}
Name Mostly(ObjectClass often, ObjectClass seldom) {
  return [=](int picture) { return picture % 5 == 2 ? seldom : often; };
}
Name First(ObjectClass first, ObjectClass then) {
  return [=](int picture) { return picture < 3 ? first : then; };
}

// As it turns it shows its flank before its returns tell the new heading: that makes no lorry of
// it.
TEST(ClassName, ACarThatTurnsFarAwayKeepsItsLength) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    for (const double turn_radps : {-0.45, 0.45}) {
      Scene scene(seed);
      scene.cars.push_back({.p_W = {40.0, 2.0}, .speed_mps = 4.3});
      Tracker tracker(TrackerConfig{}, scene.vehicle);
      double longest_m = 0.0;
      for (int step = 0; step < 200; ++step) {
        scene.cars[0].yaw_rate_radps = step > 100 && step < 180 ? turn_radps : 0.0;
        scene.Advance(kStep_s);
        scene.Radar(tracker);
        if (step % 2 == 1) scene.Camera(tracker);
        if (const LocalTrack* track = Scene::Find(tracker, scene.cars[0])) {
          longest_m = std::max(longest_m, track->extent.length_m);
        }
      }
      EXPECT_LT(longest_m, 6.0) << "seed " << seed << ", " << turn_radps;
      EXPECT_GT(longest_m, 3.0);
    }
  }
}

struct Vehicle {
  const char* what;
  Car car;
  double ego_speed_mps;
  double duration_s;
};

const Vehicle kVehicles[] = {
    {"car ahead", {.p_W = {25.0, 0.0}, .speed_mps = 12.0}, 12.0, 8.0},
    {"car oncoming", {.p_W = {110.0, 3.5}, .yaw_rad = kPi, .speed_mps = 10.0}, 8.0, 5.0},
    {"car crossing", {.p_W = {25.0, 20.0}, .yaw_rad = -0.5 * kPi, .speed_mps = 6.0}, 0.0, 6.0},
    {"truck 8.5 m ahead",
     {.p_W = {27.0, 0.0}, .speed_mps = 12.0, .length_m = 8.5, .width_m = 2.4},
     12.0,
     8.0},
    {"bus 12 m crossing",
     {.p_W = {30.0, 25.0},
      .yaw_rad = -0.5 * kPi,
      .speed_mps = 7.0,
      .length_m = 12.0,
      .width_m = 2.5},
     0.0,
     6.0},
    {"bus 18 m beside",
     {.p_W = {35.0, -3.5}, .speed_mps = 8.0, .length_m = 18.0, .width_m = 2.5},
     8.0,
     8.0},
};

void Report(const char* what, const char* name, const Seen& seen) {
  std::printf("%-20s %-28s rms %.2f m, missed %d of %d, false %d, length %.1f +- %.1f m\n", what,
              name, seen.rms_m(), seen.missed, seen.judged + seen.missed, seen.false_tracks,
              seen.length_m, seen.length_sigma_m);
}

TEST(ClassName, AWrongNameNeitherEndsATrackNorPinsItsSize) {
  using enum ObjectClass;
  for (const Vehicle& vehicle : kVehicles) {
    const ObjectClass right = vehicle.car.length_m > 11.0  ? kBus
                              : vehicle.car.length_m > 7.0 ? kTruck
                                                           : kCar;
    const std::pair<const char*, Name> names[] = {
        {"right", Always(right)},
        {"unknown", Always(kUnknown)},
        {"car", Always(kCar)},
        {"bus", Always(kBus)},
        {"truck", Always(kTruck)},
        {"pedestrian", Always(kPedestrian)},
        {"motorcycle", Always(kMotorcycle)},
        {"right, 1 in 5 pedestrian", Mostly(right, kPedestrian)},
        {"right, 1 in 5 bus", Mostly(right, kBus)},
        {"first pedestrian, then right", First(kPedestrian, right)},
        {"first bus, then right", First(kBus, right)},
    };
    double right_m = 0.0;
    for (const auto& [label, name] : names) {
      Seen all;
      for (const std::uint64_t seed : {1, 2, 3, 4}) {
        const Seen one = Watch(vehicle.car, vehicle.ego_speed_mps, vehicle.duration_s, seed, name);
        all.judged += one.judged;
        all.missed += one.missed;
        all.false_tracks += one.false_tracks;
        all.sum += one.sum;
        all.length_m += 0.25 * one.length_m;
        all.length_sigma_m += 0.25 * one.length_sigma_m;
      }
      if (label == names[0].first) right_m = all.rms_m();
      Report(vehicle.what, label, all);
      // Measured with the size pinned by the name: up to 1.4 false tracks per list (the far half of
      // a bus that is called something else), and a third of the lists without the car.
      const double lists = all.judged + all.missed;
      EXPECT_LE(all.missed, 0.1 * lists) << vehicle.what << ", " << label;
      EXPECT_LE(all.false_tracks, 0.35 * lists) << vehicle.what << ", " << label;
      // From behind, a length is what the name says and nothing else.
      EXPECT_LE(all.rms_m(), right_m + 3.6) << vehicle.what << ", " << label;
      // From the side it is what is seen.
      if (std::abs(std::sin(vehicle.car.yaw_rad)) > 0.9) {
        EXPECT_NEAR(all.length_m, vehicle.car.length_m, 0.5) << vehicle.what << ", " << label;
      }
    }
  }
}

// Every fifth cluster holds a part of the vehicle in the next lane. The size is not forgotten for
// it, and the face that is seen stays where it is: rear, front and side.
TEST(ClassName, ClustersThatHoldAPartOfTheNextVehicleMoveNoFace) {
  const Car cars[] = {
      {.p_W = {25.0, 0.0}, .speed_mps = 5.0},
      {.p_W = {60.0, 0.0}, .yaw_rad = kPi, .speed_mps = 5.0},
      {.p_W = {25.0, 8.0}, .yaw_rad = -0.5 * kPi, .speed_mps = 3.0},
  };
  for (const Car& car : cars) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      Scene scene(seed);
      scene.cars.push_back(car);
      scene.ego.speed_mps = car.yaw_rad == 0.0 ? 5.0 : 0.0;
      Tracker tracker(TrackerConfig{}, scene.vehicle);
      for (int step = 0; step < 100; ++step) {
        scene.Advance(0.05);
        auto scan = scene.Scan(0);
        if (step % 5 == 4) {
          for (RadarMeasurement& z : scan) {
            z.azimuth_max_rad += FromDegrees(7.0);
            z.azimuth_rad += FromDegrees(1.0);
            z.returns += 2;
          }
        }
        tracker.Predict(scene.now());
        tracker.UpdateRadar(0, scene.ego_state(), scan, [&](const LocalTrack& track) {
          return scene.Answer(track, 0.95, scene.vehicle.radars[0].half_fov_rad, {0.0, 0.0});
        });
        if (step % 2 == 1) scene.Camera(tracker);
      }
      const LocalTrack* track = Scene::Find(tracker, scene.cars[0]);
      ASSERT_NE(track, nullptr) << car.yaw_rad << ", seed " << seed;
      const Eigen::Vector2d forward(std::cos(car.yaw_rad), std::sin(car.yaw_rad));
      const Eigen::Vector2d off = track->state_O.mean.head<2>() - scene.cars[0].p_W;
      // Of the end that is nearer to the ego.
      const double face_m = off.dot(forward) - 0.5 * (track->extent.length_m - car.length_m);
      if (std::abs(std::sin(car.yaw_rad)) < 0.5) {
        const double seen_m =
            car.yaw_rad == 0.0 ? face_m : off.dot(forward) + 0.5 * (track->extent.length_m - 4.5);
        EXPECT_LT(std::abs(seen_m), 0.4) << car.yaw_rad << ", seed " << seed;
      } else {
        EXPECT_LT(off.norm(), 0.6) << "side, seed " << seed;
      }
      EXPECT_LT(track->extent.length_sigma_m, 1.0) << car.yaw_rad << ", seed " << seed;
    }
  }
}

}  // namespace
}  // namespace v2vouch
