// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/v2v/perception/priority_scene.h"

namespace v2vouch {
namespace {

// Whose of them the car is, nobody knows.
TEST(PriorityIdentity, SeveralIdsThatClaimOneCarFromTheFirstAreAllWithdrawnNotAccused) {
  Scene scene;
  scene.cars = {OncomingCar()};
  scene.Run(5.0, [&] {
    for (const SenderId sender : {1u, 2u, 3u}) {
      if (scene.frames % 2 == 0) scene.Say(sender, scene.cars[0].p, kPi, 5.0, 0.3);
    }
    EXPECT_LE(scene.Priority().size(), 1u);
  });
  EXPECT_TRUE(scene.Priority().empty());
  for (const SenderId sender : {1u, 2u, 3u}) {
    EXPECT_EQ(scene.perception.TrustOf(sender), TrustState::kSuspect) << sender;
  }
}

// The message stream then jumps with every message of either; who of them lies is seen by the
// sensors alone.
TEST(PriorityIdentity, ImpersonatedVehicleGoesOnWhileItIsSeen) {
  for (const Check check : {Check::kPositionJump, Check::kTwoPlaces, Check::kOwnMotion}) {
    Scene scene = Validated(7);
    const Finding jump{check, Verdict::kWithdraw, "displacement_m", 12.0, 3.0};
    scene.Run(4.0, [&] {
      const Car& car = scene.cars[0];
      if (scene.frames % 2 == 0) {
        scene.Say(1, car.p + Eigen::Vector2d(1.0, -0.8), kPi, 5.0, 0.5, 60.0, jump);
      } else if (scene.frames % 4 == 1) {
        scene.Say(1, car.p + Eigen::Vector2d(0.0, -12.0), kPi, 5.0, 0.3, 60.0, jump);
      }
      ASSERT_EQ(scene.Priority().size(), 1u) << NameOf(check);
      EXPECT_LT(ErrorOf(scene.Priority()[0], car), 1.0) << NameOf(check);
    });
    EXPECT_TRUE(scene.outputs.reports.empty()) << NameOf(check);
  }
}

TEST(PriorityIdentity, HonestIdentityChangeKeepsTheVehicleSeenOrHidden) {
  for (const bool is_hidden : {false, true}) {
    Scene scene = Validated(7);
    const std::uint64_t id = scene.Priority()[0].track.id;
    if (is_hidden) {
      Hide(scene);
      scene.Run(1.0, [&] { scene.Honest(1); });
    }
    const double budget_s = scene.Priority()[0].bridge_budget_s;
    scene.Run(0.2, [] {});  // The change of pseudonym itself.
    scene.Run(2.0, [&] {
      scene.Honest(2);
      ASSERT_EQ(scene.Priority().size(), 1u) << is_hidden;
      EXPECT_EQ(scene.Priority()[0].track.id, id);
    });
    EXPECT_EQ(scene.Priority()[0].sender, 2u);
    if (is_hidden) {
      EXPECT_NEAR(scene.Priority()[0].bridge_budget_s, budget_s - 2.2, 0.1);
    }
    EXPECT_TRUE(scene.outputs.reports.empty());
  }
}

// A sender whose messages are lost for a while has not changed its pseudonym to that of the car
// beside: that one was heard before.
TEST(PriorityIdentity, AnIdThatWasHeardBeforeIsNoNewPseudonym) {
  Scene scene = Validated(8, 4.0);
  const auto beside = [&] { scene.Honest(2, {0.0, 2.5}); };
  scene.Run(0.2, [&] {
    scene.Honest(1);
    beside();
  });
  scene.Run(0.8, beside);
  scene.Run(0.2, [&] { scene.Honest(1); });
  ASSERT_EQ(scene.Priority().size(), 1u);
  EXPECT_EQ(scene.Priority()[0].sender, 1u);
  EXPECT_NE(scene.perception.TrustOf(2), TrustState::kSuspect);
  EXPECT_TRUE(scene.outputs.reports.empty());
}

TEST(PriorityIdentity, OldIdThatSpeaksAgainTakesItsVehicleBack) {
  Scene scene = Validated(8);
  scene.Run(0.3, [] {});
  scene.Run(0.6, [&] { scene.Honest(2); });
  ASSERT_EQ(scene.Priority().size(), 1u);
  ASSERT_EQ(scene.Priority()[0].sender, 2u);
  scene.Run(0.2, [&] { scene.Honest(1); });
  ASSERT_EQ(scene.Priority().size(), 1u);
  EXPECT_EQ(scene.Priority()[0].sender, 1u);
  EXPECT_EQ(scene.perception.TrustOf(2), TrustState::kSuspect);
}

TEST(PriorityIdentity, SecondIdOnTheSameCarNeverGetsIn) {
  Scene scene = Validated(9);
  scene.Run(5.0, [&] {
    scene.Honest(1);
    scene.Honest(2, {0.1, 0.0});
    ASSERT_EQ(scene.Priority().size(), 1u);
    EXPECT_EQ(scene.Priority()[0].sender, 1u);
  });
}

}  // namespace
}  // namespace v2vouch
