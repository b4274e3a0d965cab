// SPDX-License-Identifier: Apache-2.0
// Direction of travel through manoeuvres: no track older than a second may turn round by 180
// degrees, none may spin where it stands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "daemon/common/base/angle.h"
#include "tests/daemon/local/tracking/scene.h"

namespace v2vouch {
namespace {

constexpr double kStep_s = 0.05;

/// What became of one car's direction, on tracks older than a second.
struct Course {
  int judged = 0;
  int missed = 0;  ///< Steps after the first two seconds without a track on the car.
  int switches = 0;
  int flips = 0;  ///< From below 90 degrees of error to above, on one track.
  double worst_rad = 0.0;
  double final_speed_mps = 0.0;
  double spin_rad = 0.0;  ///< Widest span of the track's yaw while the car stands.
};

/// Runs a scene with one car to judge (the first) at 20 Hz, with a picture every second scan.
/// @param drive changes the scene before each step; gets the time.
/// @param with_camera whether there are pictures at that time.
Course Follow(Scene& scene, double duration_s, const std::function<void(double)>& drive,
              const std::function<bool(double)>& with_camera) {
  Tracker tracker(TrackerConfig{}, scene.vehicle);
  Course heading;
  std::uint64_t id = 0;
  bool was_reversed = false;
  double stands_s = 0.0, spin_from = 0.0, low = 0.0, high = 0.0;
  for (int step = 0; kStep_s * step < duration_s; ++step) {
    const double t_s = kStep_s * step;
    drive(t_s);
    scene.Advance(kStep_s);
    scene.Radar(tracker);
    if (step % 2 == 1 && with_camera(t_s)) scene.Camera(tracker);
    const Car& car = scene.cars[0];
    const LocalTrack* track = Scene::Find(tracker, car);
    stands_s = car.speed_mps == 0.0 ? stands_s + kStep_s : 0.0;
    if (track == nullptr) {
      heading.missed += t_s > 2.0 ? 1 : 0;
      stands_s = 0.0;
      continue;
    }
    if (id != 0 && id != track->id) ++heading.switches;
    if (id != track->id) was_reversed = false;
    id = track->id;
    if (ToSeconds(scene.now() - track->start) <= 1.0) continue;
    const double yaw = track->state_O.mean[kYaw];
    const double error = std::abs(WrapAngle(yaw - car.yaw_rad));
    const bool is_reversed = error > 0.5 * kPi;
    if (is_reversed && !was_reversed) ++heading.flips;
    was_reversed = is_reversed;
    ++heading.judged;
    heading.worst_rad = std::max(heading.worst_rad, error);
    heading.final_speed_mps = track->state_O.mean[kSpeed];
    // The stop itself may still teach something in its first second.
    if (stands_s < 1.0) {
      spin_from = yaw;
      low = high = 0.0;
      continue;
    }
    const double turned = WrapAngle(yaw - spin_from);
    low = std::min(low, turned);
    high = std::max(high, turned);
    heading.spin_rad = std::max(heading.spin_rad, high - low);
  }
  return heading;
}

bool Always(double) { return true; }
bool Never(double) { return false; }

constexpr std::uint64_t kSeeds[] = {1, 2, 3, 4, 5, 6, 7, 8};

void Expect(const Course& h, std::uint64_t seed, const char* what, double worst_deg) {
  std::printf(
      "%-28s seed %llu: worst %5.1f deg, spin %4.1f deg, %d flips, %d switches, %d missed\n", what,
      static_cast<unsigned long long>(seed), ToDegrees(h.worst_rad), ToDegrees(h.spin_rad), h.flips,
      h.switches, h.missed);
  EXPECT_GT(h.judged, 20) << what << seed;
  EXPECT_EQ(h.flips, 0) << what << seed;
  EXPECT_EQ(h.missed, 0) << what << seed;
  EXPECT_LT(ToDegrees(h.worst_rad), worst_deg) << what << seed;
}

/// The same, and it is one track all the time.
void ExpectOneTrack(const Course& h, std::uint64_t seed, const char* what, double worst_deg) {
  Expect(h, seed, what, worst_deg);
  EXPECT_EQ(h.switches, 0) << what << seed;
}

/// Brakes from `from_s` on until it stands.
void BrakeToRest(Car& car, double t_s, double from_s, double decel_mps2) {
  if (t_s < from_s || car.speed_mps == 0.0) return;
  car.accel_mps2 = -decel_mps2;
  if (car.speed_mps > decel_mps2 * kStep_s) return;
  car.speed_mps = car.accel_mps2 = car.yaw_rate_radps = 0.0;
}

TEST(Heading, CarThatStopsStandsStillForTwentySeconds) {
  for (const bool with_camera : {true, false}) {
    for (const std::uint64_t seed : kSeeds) {
      Scene scene(seed);
      scene.cars.push_back({.p_W = {15.0, -2.0}, .yaw_rad = 0.05, .speed_mps = 9.0});
      const Course h = Follow(
          scene, 27.0, [&](double t_s) { BrakeToRest(scene.cars[0], t_s, 3.0, 3.0); },
          with_camera ? Always : Never);
      ExpectOneTrack(h, seed, with_camera ? "stops, radar and camera" : "stops, radar", 15.0);
      EXPECT_LT(ToDegrees(h.spin_rad), 5.0) << seed;
    }
  }
}

TEST(Heading, CarThatStopsAcrossTheViewStandsStill) {
  for (const std::uint64_t seed : kSeeds) {
    Scene scene(seed);
    scene.cars.push_back({.p_W = {28.0, -18.0}, .yaw_rad = 0.5 * kPi, .speed_mps = 7.0});
    const Course h = Follow(
        scene, 26.0, [&](double t_s) { BrakeToRest(scene.cars[0], t_s, 2.0, 3.0); }, Always);
    ExpectOneTrack(h, seed, "stops across the view", 20.0);
    EXPECT_LT(ToDegrees(h.spin_rad), 5.0) << seed;
  }
}

TEST(Heading, CarThatStartsAgainGoesForward) {
  for (const std::uint64_t seed : kSeeds) {
    Scene scene(seed);
    scene.cars.push_back({.p_W = {15.0, 2.0}, .yaw_rad = 0.0, .speed_mps = 8.0});
    const Course h = Follow(
        scene, 14.0,
        [&](double t_s) {
          Car& car = scene.cars[0];
          if (t_s < 8.0) return BrakeToRest(car, t_s, 2.0, 3.0);
          car.accel_mps2 = car.speed_mps < 8.0 ? 2.0 : 0.0;
        },
        Always);
    ExpectOneTrack(h, seed, "stops and starts", 15.0);
    EXPECT_GT(h.final_speed_mps, 5.0) << seed;
  }
}

TEST(Heading, ReversingCarKeepsItsYawAndHasNegativeSpeed) {
  for (const std::uint64_t seed : kSeeds) {
    Scene scene(seed);
    scene.cars.push_back({.p_W = {20.0, 2.0}, .yaw_rad = 0.0, .speed_mps = 6.0});
    const Course h = Follow(
        scene, 14.0,
        [&](double t_s) {
          Car& car = scene.cars[0];
          if (t_s < 6.0) return BrakeToRest(car, t_s, 2.0, 2.5);
          car.accel_mps2 = car.speed_mps > -2.5 ? -1.0 : 0.0;
        },
        Always);
    ExpectOneTrack(h, seed, "stops and reverses", 20.0);
    EXPECT_LT(h.final_speed_mps, -1.5) << seed;
  }
}

TEST(Heading, UTurnIsFollowed) {
  for (const std::uint64_t seed : kSeeds) {
    Scene scene(seed);
    scene.cars.push_back({.p_W = {20.0, -4.0}, .yaw_rad = 0.0, .speed_mps = 8.0});
    // Half a circle to the left at 4 m/s and 6 m radius.
    const Course h = Follow(
        scene, 15.0,
        [&](double t_s) {
          Car& car = scene.cars[0];
          car.accel_mps2 = t_s > 2.0 && t_s < 4.0 ? -2.0 : 0.0;
          const bool is_turning = t_s >= 4.5 && car.yaw_rad < kPi - 0.02;
          car.yaw_rate_radps = is_turning ? 4.0 / 6.0 : 0.0;
        },
        Always);
    ExpectOneTrack(h, seed, "U-turn", 45.0);
    EXPECT_GT(h.final_speed_mps, 2.0) << seed;
  }
}

// Which of a lorry's parts carries its identity is another matter; none may turn round.
TEST(Heading, LorryThatPassesInTheNextLaneKeepsItsHeading) {
  for (const bool is_oncoming : {false, true}) {
    for (const std::uint64_t seed : kSeeds) {
      Scene scene(seed);
      scene.split = 3;
      scene.ego.speed_mps = is_oncoming ? 8.0 : 6.0;
      scene.cars.push_back({.p_W = {is_oncoming ? 95.0 : 22.0, 4.0},
                            .yaw_rad = is_oncoming ? kPi : 0.0,
                            .speed_mps = 9.0,
                            .length_m = 12.0,
                            .width_m = 2.5,
                            .object_class = ObjectClass::kTruck});
      const Course h = Follow(
          scene, is_oncoming ? 4.2 : 10.0, [](double) {}, Always);
      Expect(h, seed, is_oncoming ? "oncoming lorry" : "lorry ahead", 30.0);
    }
  }
}

/// A parked car that was never seen to move has no known front: at most its axis can be told.
TEST(Heading, ParkedCarFoundByTheCameraDoesNotSpin) {
  for (const std::uint64_t seed : kSeeds) {
    Scene scene(seed);
    scene.cars.push_back({.p_W = {22.0, 4.0}, .yaw_rad = 0.1});
    const Course h = Follow(
        scene, 22.0, [](double) {}, Always);
    EXPECT_EQ(h.switches, 0) << seed;
    EXPECT_EQ(h.missed, 0) << seed;
    EXPECT_EQ(h.flips, 0) << seed;
    std::printf("parked, seed %llu: worst %.1f deg, spin %.1f deg\n",
                static_cast<unsigned long long>(seed), ToDegrees(h.worst_rad),
                ToDegrees(h.spin_rad));
    EXPECT_LT(ToDegrees(h.spin_rad), 10.0) << seed;
  }
}

// What is seen of a car that stands slides from its tail round a corner to its flank while it is
// passed: that is no motion of the car. Cars of a row come into view one after the other, late.
TEST(Heading, StandingCarsThatArePassedCloselyDoNotSeemToCreepAcross) {
  int judged = 0, creeping = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Scene scene(seed);
    const double from_m = 12.0 + 0.3 * static_cast<double>(seed);
    scene.vehicle = OneRadarOneCamera();
    scene.ego.speed_mps = 14.0;
    for (int i = 0; i < 7; ++i) {
      scene.cars.push_back({.p_W = {40.0 + 7.0 * i, i % 2 == 0 ? -2.6 : 2.6}});
    }
    Tracker tracker(TrackerConfig{}, scene.vehicle);
    for (int step = 0; step < 120; ++step) {
      for (Car& car : scene.cars) {
        const double ahead_m = car.p_W.x() - scene.ego.p_W.x();
        car.is_absent = ahead_m > from_m;
      }
      scene.Advance(kStep_s);
      scene.Radar(tracker);
      if (step % 2 == 1) scene.Camera(tracker);
      for (const LocalTrack& track : tracker.tracks()) {
        if (!track.is_confirmed) continue;
        ++judged;
        const StateVector& x = track.state_O.mean;
        const double sigma = std::sqrt(track.state_O.covariance(kYaw, kYaw));
        creeping += std::abs(x[kSpeed]) > 1.0 && sigma < 0.25 && std::abs(std::sin(x[kYaw])) > 0.5;
      }
    }
  }
  std::printf("passed: %d of %d lists creep\n", creeping, judged);
  ASSERT_GT(judged, 500);
  EXPECT_LT(creeping, judged / 50);
}

// So does what is seen of a queue that creeps in the next lane while it is passed.
TEST(Heading, SlowCarsThatArePassedCloselyDoNotSeemToTurnIn) {
  int judged = 0, turning = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Scene scene(seed);
    scene.vehicle = OneRadarOneCamera();
    scene.ego.speed_mps = 14.0;
    for (int i = 0; i < 5; ++i) {
      scene.cars.push_back({.p_W = {60.0 + 8.0 * i, 3.0}, .speed_mps = 2.0});
    }
    Tracker tracker(TrackerConfig{}, scene.vehicle);
    for (int step = 0; step < 150; ++step) {
      scene.Advance(kStep_s);
      // Cars of a queue hide each other: one scan of four shows them.
      if (step % 4 == 0) scene.Radar(tracker);
      if (step % 2 == 1) scene.Camera(tracker);
      for (const LocalTrack& track : tracker.tracks()) {
        const StateVector& x = track.state_O.mean;
        if (!track.is_confirmed || x[kX] > scene.ego.p_W.x() + 25.0) continue;
        ++judged;
        const double sigma = std::sqrt(track.state_O.covariance(kYaw, kYaw));
        turning += sigma < 0.25 && std::abs(std::sin(x[kYaw])) > std::sin(FromDegrees(15.0));
      }
    }
  }
  std::printf("passed slowly: %d of %d lists turn in\n", turning, judged);
  ASSERT_GT(judged, 500);
  EXPECT_LT(turning, judged / 300);
}

}  // namespace
}  // namespace v2vouch
