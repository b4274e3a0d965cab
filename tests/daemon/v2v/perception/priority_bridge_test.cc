// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/v2v/perception/priority_scene.h"

namespace v2vouch {
namespace {

TEST(PriorityBridge, BridgesFourSecondsAndTakesTheVehicleBackUnderItsId) {
  double squared = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scene scene = Validated(seed);
    const std::uint64_t id = scene.Priority()[0].track.id;
    Hide(scene);
    scene.Run(4.0, [&] {
      scene.Honest(1);
      const auto lines = scene.Priority();
      ASSERT_EQ(lines.size(), 1u) << "seed " << seed;
      EXPECT_EQ(lines[0].track.id, id);
      squared += std::pow(ErrorOf(lines[0], scene.cars[0]), 2);
      ++count;
    });
    EXPECT_EQ(scene.Priority()[0].trust, TrustState::kBridged);
    EXPECT_EQ(scene.Priority()[0].local_id, 0u);
    EXPECT_EQ(scene.Priority()[0].track.visibility, Visibility::kHidden);
    // Back in view as a new LOCAL track.
    scene.has_wall = false;
    scene.cars[0] = {.local_id = 8,
                     .p = scene.cars[0].p,
                     .yaw_rad = scene.cars[0].yaw_rad,
                     .speed_mps = scene.cars[0].speed_mps};
    scene.Run(1.0, [&] { scene.Honest(1); });
    const auto lines = scene.Priority();
    ASSERT_EQ(lines.size(), 1u) << "seed " << seed;
    EXPECT_EQ(lines[0].track.id, id);
    EXPECT_EQ(lines[0].local_id, 8u);
    EXPECT_EQ(lines[0].trust, TrustState::kValidated);
    EXPECT_TRUE(scene.outputs.reports.empty());
  }
  EXPECT_LT(std::sqrt(squared / count), 0.6);
}

// LOCAL stops listing a hidden vehicle for a second and lists the same track again when it has been
// measured: no new track, and the vehicle's own.
TEST(PriorityBridge, ComesBackAsItsOwnTrackThatWasNotListedMeanwhile) {
  Scene scene = Validated(14);
  const std::uint64_t id = scene.Priority()[0].track.id;
  Hide(scene);
  scene.Run(1.5, [&] { scene.Honest(1); });
  ASSERT_EQ(scene.Priority().size(), 1u);
  EXPECT_EQ(scene.Priority()[0].local_id, 0u);
  scene.has_wall = false;
  scene.cars[0].is_seen = true;
  scene.Run(0.25, [&] { scene.Honest(1); });
  ASSERT_EQ(scene.Priority().size(), 1u);
  EXPECT_EQ(scene.Priority()[0].track.id, id);
  EXPECT_EQ(scene.Priority()[0].local_id, 7u);
}

// A sender leaves its vehicle to the side, at 1 m/s and with the heading to match, and after 2.5 s
// the vehicle is hidden: too early to withdraw it, but it would take the bridge along.
TEST(PriorityBridge, NoBridgeFollowsASenderThatWasWalkingOff) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Scene scene = Validated(seed);
    double aside_m = 0.0;
    const auto walk = [&] {
      aside_m += kFrame_s * 1.0;
      if (scene.frames % 2 != 0) return;
      const Car& car = scene.cars[0];
      scene.Say(1, car.p + Eigen::Vector2d(1.0, -0.8 - aside_m), car.yaw_rad + 0.2, car.speed_mps);
    };
    scene.Run(2.5, walk);
    ASSERT_EQ(scene.Priority().size(), 1u) << "seed " << seed;
    EXPECT_TRUE(scene.outputs.reports.empty()) << "seed " << seed;
    Hide(scene);
    scene.Run(0.5, walk);
    EXPECT_TRUE(scene.Priority().empty()) << "seed " << seed;
    EXPECT_TRUE(scene.outputs.reports.empty()) << "seed " << seed;
  }
}

// A new LOCAL track, 6.5 m from the bridge but where the sensors alone may expect the hidden car: a
// few stray hits say nothing, a run says that the car is there.
TEST(PriorityBridge, StrayHitsElsewhereEndNoBridge) {
  for (const int hits : {3, 8}) {
    Scene scene = Validated(7);
    Hide(scene);
    scene.Run(2.5, [&] { scene.Honest(1); });
    scene.cars.push_back({.local_id = 8, .yaw_rad = kPi, .speed_mps = 5.0});
    for (int i = 0; i < 20; ++i) {
      scene.Move(kFrame_s);
      scene.cars[1].p = scene.cars[0].p + Eigen::Vector2d(-6.5, 0.0);
      scene.cars[1].is_seen = i < hits;
      scene.Frame();
      scene.Honest(1);
    }
    EXPECT_EQ(scene.Priority().size(), hits == 3 ? 1u : 0u) << hits;
    EXPECT_EQ(scene.outputs.reports.empty(), hits == 3);
    for (const auto& report : scene.outputs.reports) EXPECT_EQ(report.check, Check::kSeenElsewhere);
  }
}

TEST(PriorityBridge, PlaceInClearViewThatIsEmptyEndsTheBridgeWithinASecond) {
  Scene scene = Validated(2);
  scene.cars[0].is_seen = false;  // Gone, and nothing hides the place.
  const Timestamp lost = scene.now;
  Timestamp ended{};
  scene.Run(3.0, [&] {
    scene.Honest(1);
    if (ended == Timestamp{} && scene.Priority().empty()) ended = scene.now;
  });
  ASSERT_NE(ended, Timestamp{});
  EXPECT_LT(ToSeconds(ended - lost), 1.4);  // 0.35 s of missing support and about a second.
  ASSERT_FALSE(scene.outputs.reports.empty());
  EXPECT_EQ(scene.outputs.reports[0].check, Check::kEmptyPlace);
  EXPECT_EQ(scene.outputs.reports[0].verdict, Verdict::kWithdraw);
  EXPECT_EQ(scene.perception.TrustOf(1), TrustState::kSuspect);
}

// The last look at a part had it turned, and its sender speaks every 0.8 s: three messages that do
// not fit would carry it 8 m astray.
TEST(PriorityBridge, WhoSpeaksSeldomIsHeardAtTheFirstMessageThatDoesNotFit) {
  Scene scene = Validated(3);
  Hide(scene);
  scene.cars[0].yaw_rad = WrapAngle(scene.cars[0].yaw_rad + 0.7);
  scene.Run(3.0, [&] {
    if (scene.frames % 16 == 0) {
      scene.Say(1, scene.cars[0].p + Eigen::Vector2d(1.0, -0.8), scene.cars[0].yaw_rad, 5.0);
    }
    for (const auto& line : scene.Priority()) EXPECT_LT(ErrorOf(line, scene.cars[0]), 5.0);
  });
  EXPECT_TRUE(scene.outputs.reports.empty());
}

TEST(PriorityBridge, BudgetEndsTheBridgeWithoutBlame) {
  Scene scene = Validated(3, 4.5, 120.0);
  const double budget_s = scene.Priority()[0].bridge_budget_s;
  EXPECT_GE(budget_s, 4.5);
  EXPECT_LT(budget_s, 10.0);
  Hide(scene);
  const Timestamp lost = scene.now;
  Timestamp ended{};
  scene.Run(11.0, [&] {
    scene.Honest(1);
    if (ended == Timestamp{} && scene.Priority().empty()) ended = scene.now;
  });
  ASSERT_NE(ended, Timestamp{});
  // The claims round the last hit still count as co-observed.
  EXPECT_NEAR(ToSeconds(ended - lost), budget_s, 0.35);
  EXPECT_TRUE(scene.outputs.reports.empty());
  EXPECT_TRUE(scene.Priority().empty());
}

TEST(PriorityBridge, SilenceEndsTheBridgeAfterOneSecondAndTheSightAfterTwo) {
  Scene hidden = Validated(4);
  Hide(hidden);
  hidden.Run(0.9, [] {});
  EXPECT_EQ(hidden.Priority().size(), 1u);
  hidden.Run(0.3, [] {});
  EXPECT_TRUE(hidden.Priority().empty());

  Scene seen = Validated(4);
  const std::uint64_t id = seen.Priority()[0].track.id;
  seen.Run(1.8, [] {});
  EXPECT_EQ(seen.Priority().size(), 1u);
  seen.Run(0.4, [] {});
  EXPECT_TRUE(seen.Priority().empty());
  seen.Run(3.0, [&] { seen.Honest(1); });  // Speaks again: same LOCAL track, same id.
  ASSERT_EQ(seen.Priority().size(), 1u);
  EXPECT_EQ(seen.Priority()[0].track.id, id);
}

// What hides a vehicle is the likeliest to be taken for it.
TEST(PriorityBridge, AHiddenVehiclesLocalTrackThatGoesOverToItsNeighbourDragsNothing) {
  for (const double aside_m : {-3.5, 3.5}) {
    Scene scene = Validated(10);
    const std::uint64_t id = scene.Priority()[0].track.id;
    Hide(scene);
    scene.cars[0].is_coasting = true;
    scene.Run(0.6, [&] { scene.Honest(1); });
    scene.cars[0].is_coasting = false;
    Car neighbour = scene.cars[0];  // Goes on under the same LOCAL id.
    neighbour.p.y() += aside_m;
    neighbour.speed_mps -= 1.0;
    neighbour.is_seen = true;
    scene.cars.push_back(neighbour);
    scene.Run(3.0, [&] {
      scene.Honest(1);
      const auto lines = scene.Priority();
      ASSERT_EQ(lines.size(), 1u) << aside_m;
      EXPECT_EQ(lines[0].track.id, id);
      EXPECT_EQ(lines[0].local_id, 0u);
      EXPECT_LT(ErrorOf(lines[0], scene.cars[0]), 1.5) << aside_m;
    });
    EXPECT_TRUE(scene.outputs.reports.empty());
  }
}

TEST(PriorityBridge, ABridgeEndsWhereTheSensorsSeeAnotherVehicleOfTheList) {
  Scene scene = Validated(11);
  Car slow = OncomingCar();
  slow.local_id = 9;
  slow.p = scene.cars[0].p - Eigen::Vector2d(14.0, 0.0);
  slow.speed_mps = 2.0;
  scene.cars.push_back(slow);
  const auto both = [&] {
    scene.Honest(1);
    if (scene.frames % 2 == 1) scene.Say(2, scene.cars[1].p, kPi, 2.0);
  };
  scene.Run(3.0, both);
  ASSERT_EQ(scene.Priority().size(), 2u);
  Hide(scene);  // The first: what follows would drive through the second.
  scene.Run(3.0, [&] {
    both();
    const auto lines = scene.Priority();
    if (lines.size() < 2) return;
    const Eigen::Vector2d apart =
        (lines[0].track.state_O.mean - lines[1].track.state_O.mean).head<2>();
    EXPECT_GT(apart.norm(), 1.5);
  });
  ASSERT_EQ(scene.Priority().size(), 1u);
  EXPECT_EQ(scene.Priority()[0].sender, 2u);
  EXPECT_TRUE(scene.outputs.reports.empty());
}

TEST(PriorityBridge, ANeighbourInTheNextLaneDoesNotExplainABridgeInClearView) {
  Scene scene = Validated(13);
  Car neighbour = scene.cars[0];
  neighbour.local_id = 9;
  neighbour.p.y() += 2.9;
  scene.cars.push_back(neighbour);
  scene.cars[0].is_seen = false;  // Gone, in clear view.
  const Timestamp gone = scene.now;
  while (!scene.Priority().empty() && ToSeconds(scene.now - gone) < 5.0) {
    scene.Run(0.05, [&] { scene.Honest(1); });
  }
  EXPECT_LT(ToSeconds(scene.now - gone), 2.5);
}

// Sensors and sender have come apart by more than any bias, and no check was there to part them:
// hidden, the vehicle would be carried beside where its sender has it.
TEST(PriorityBridge, NothingIsBridgedOnABiasThatIsNone) {
  PriorityConfig config;
  config.trust.level_withdraw_m = config.trust.drift_withdraw_m = 50.0;
  config.trust.torn_m = config.trust.leaving_m = 20.0;
  for (const double apart_m : {3.0, 8.0}) {
    Scene scene(12, config);
    scene.cars = {OncomingCar(95.0)};
    scene.Run(3.0, [&] { scene.Honest(1, {0.0, 0.0}); });
    double left_m = 0.0;
    scene.Run(10.0, [&] {
      left_m = std::min(apart_m, left_m + 0.05);
      scene.Honest(1, {0.0, left_m});
    });
    ASSERT_EQ(scene.Priority().size(), 1u);
    Hide(scene);
    scene.Run(0.5, [&] { scene.Honest(1, {0.0, left_m}); });
    EXPECT_EQ(scene.Priority().size(), apart_m < 5.0 ? 1u : 0u);
    EXPECT_TRUE(scene.outputs.reports.empty());
  }
}

TEST(PriorityBridge, ABridgeEndsFarFromTheEgo) {
  PriorityConfig config;
  config.bridge.max_distance_m = 35.0;
  Scene scene(12, config);
  scene.cars = {OncomingCar()};
  scene.Run(6.0, [&] { scene.Honest(1); });  // Seen at 40 m: nothing ends.
  ASSERT_EQ(scene.Priority().size(), 1u);
  Hide(scene);
  scene.Run(0.6, [&] { scene.Honest(1); });
  EXPECT_TRUE(scene.Priority().empty());
  EXPECT_TRUE(scene.outputs.reports.empty());
}

}  // namespace
}  // namespace v2vouch
