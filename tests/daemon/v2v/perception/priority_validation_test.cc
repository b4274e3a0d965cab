// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/v2v/perception/priority_scene.h"

namespace v2vouch {
namespace {

TEST(PriorityValidation, NothingIsPublishedBeforeTheRunOfAgreement) {
  Scene scene;
  scene.cars = {OncomingCar()};
  scene.Run(1.5, [&] {
    scene.Honest(1);
    EXPECT_TRUE(scene.Priority().empty());
  });
}

TEST(PriorityValidation, GhostIsNeverPublished) {
  Random places(99);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Scene scene(seed);
    scene.cars = {OncomingCar()};
    scene.has_wall = seed % 2 == 0;
    scene.cars[0].is_seen = !scene.has_wall;
    const bool rides_along = seed % 3 == 0;  // Beside the real car, 8 m off, same speed.
    Eigen::Vector2d ghost(places.Uniform(5.0, 120.0), places.Uniform(-40.0, 40.0));
    const double yaw_rad = places.Uniform(-kPi, kPi);
    const double speed_mps = places.Uniform(0.0, 15.0);
    scene.Run(8.0, [&] {
      const Car& car = scene.cars[0];
      ghost += kFrame_s * speed_mps * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
      if (rides_along) {
        scene.Say(66, car.p + Eigen::Vector2d(0.0, 8.0), car.yaw_rad, car.speed_mps, 0.1);
      } else if ((ghost - car.p).norm() > 7.0) {
        scene.Say(66, ghost, yaw_rad, speed_mps, 0.1);
      }
      EXPECT_TRUE(scene.Priority().empty()) << "seed " << seed;
    });
  }
}

// Two cars in a queue, 5.5 m from centre to centre; LOCAL has the first, the second talks.
TEST(PriorityValidation, StandingNeighbourIsNotTheCarInFront) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Scene scene(seed);
    scene.cars = {{.local_id = 7, .p = {40.0, 3.5}, .yaw_rad = 0.5 * kPi, .speed_mps = 0.0}};
    scene.Run(15.0, [&] {
      scene.Honest(1, {0.0, -5.5});
      EXPECT_TRUE(scene.Priority().empty()) << "seed " << seed;
    });
  }
}

// A claim 3 m behind a standing car may be that car's, or that of the next in the queue, where none
// can be seen. Where the place behind is in clear view and empty, or the claim is nearer, it is
// not.
TEST(PriorityValidation, WhoMayBeTheUnseenNextInTheQueueIsNotValidated) {
  struct Case {
    double behind_m;
    bool has_screen;
    bool is_validated;
  };
  for (const Case& now : {Case{3.0, true, false}, Case{3.0, false, true}, Case{1.0, true, true}}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      Scene scene(seed);
      scene.cars = {{.local_id = 7, .p = {40.0, 3.5}, .yaw_rad = 0.5 * kPi, .speed_mps = 0.0}};
      if (now.has_screen) {
        scene.screen = {.id = 1, .centre_O = {20.0, -2.5}, .yaw_rad = 0.5 * kPi, .length_m = 4.5};
      }
      scene.Run(6.0, [&] { scene.Honest(1, {0.0, -now.behind_m}); });
      EXPECT_EQ(scene.Priority().size() == 1u, now.is_validated)
          << now.behind_m << " m, screen " << now.has_screen << ", seed " << seed;
    }
  }
}

// A hidden sender, and a car without radio that passes it in the next lane.
TEST(PriorityValidation, WhoPassesAHiddenSenderIsNotTheSender) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Scene scene(seed);
    scene.cars = {{.local_id = 7, .p = {35.0, 2.0}, .speed_mps = 12.0, .is_part = true}};
    Eigen::Vector2d hidden(37.0, -0.8);
    scene.Run(3.0, [&] {
      hidden.x() += 10.0 * kFrame_s;
      if (scene.frames % 2 == 0) scene.Say(1, hidden, 0.0, 10.0);
      EXPECT_TRUE(scene.Priority().empty()) << "seed " << seed;
    });
  }
}

TEST(PriorityValidation, CarOnTheBridgeAboveIsNotTheCarBelow) {
  Scene scene;
  scene.cars = {OncomingCar()};
  scene.Run(5.0, [&] {
    scene.Say(1, scene.cars[0].p, kPi, 5.0, 0.3, 66.0);
    EXPECT_TRUE(scene.Priority().empty());
  });
}

TEST(PriorityValidation, NobodyIsValidatedWhileTheEgosPlaceIsInDoubt) {
  Scene scene;
  scene.cars = {OncomingCar()};
  // Before that it is one of several openings, and simply overruled.
  scene.Run(12.0, [&] { scene.Fix(); });
  scene.cars = {OncomingCar()};
  for (int i = 0; i < 5; ++i) scene.Fix({50.0, 0.0});
  ASSERT_TRUE(scene.perception.alignment().is_suspect());
  scene.Run(4.0, [&] {
    scene.Honest(1);
    scene.Fix({50.0, 0.0});
    EXPECT_TRUE(scene.Priority().empty());
  });
}

}  // namespace
}  // namespace v2vouch
