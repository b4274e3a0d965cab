// SPDX-License-Identifier: Apache-2.0
// What of the trust in senders goes over a restart of the program.
#include "tests/daemon/v2v/perception/priority_scene.h"

namespace v2vouch {
namespace {

// Seconds until the sender's car is in PRIORITY in a fresh start that was told `memories`; -1:
// never.
double SecondsToEnter(const std::vector<TrustMemory>& memories, double for_s = 8.0) {
  Scene scene(2);
  scene.perception.RestoreTrust(memories);
  scene.cars = {OncomingCar()};
  double entered_s = -1.0;
  const Timestamp begin = scene.now;
  scene.Run(for_s, [&] {
    scene.Honest(1);
    if (entered_s < 0.0 && !scene.Priority().empty()) entered_s = ToSeconds(scene.now - begin);
  });
  return entered_s;
}

TEST(PriorityRestart, ASuspectDoesNotWashItselfByOurRestart) {
  Scene scene = Validated(6);
  scene.Run(1.0, [&] {
    if (scene.frames % 2 == 0) {
      scene.Say(1, scene.cars[0].p + Eigen::Vector2d(0.0, 30.0), kPi, 5.0);
    }
  });
  ASSERT_EQ(scene.perception.TrustOf(1), TrustState::kSuspect);
  const auto kept = scene.perception.TrustToKeep(scene.now);
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].suspicions, 1);
  EXPECT_GT(SecondsToEnter({}), 0.0);
  EXPECT_LT(SecondsToEnter(kept), 0.0);
}

// The sensors must vouch again; whoever was relied on without blame needs less of it.
TEST(PriorityRestart, WhoWasReliedOnIsValidatedByTheSensorsAgainAndSooner) {
  Scene scene = Validated(6);
  const auto kept = scene.perception.TrustToKeep(scene.now);
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].state, TrustState::kCandidate);
  const double stranger_s = SecondsToEnter({});
  const double known_s = SecondsToEnter(kept);
  EXPECT_GT(known_s, 0.4);
  EXPECT_LT(known_s, stranger_s - 0.4);
  auto old = kept;
  old[0].since_s = 3600.0;
  EXPECT_DOUBLE_EQ(SecondsToEnter(old), stranger_s);
}

TEST(PriorityRestart, APenaltyOfASenderNotHeardAgainIsCarriedOn) {
  Scene scene;
  scene.perception.RestoreTrust(
      {{.sender = 9, .state = TrustState::kRevoked, .accusations = 2, .since_s = 5.0}});
  scene.cars = {OncomingCar()};
  scene.Run(3.0, [&] { scene.Honest(1); });
  EXPECT_EQ(scene.perception.TrustOf(9), TrustState::kRevoked);
  const auto kept = scene.perception.TrustToKeep(scene.now);
  const auto nine = std::ranges::find(kept, 9u, &TrustMemory::sender);
  ASSERT_NE(nine, kept.end());
  EXPECT_EQ(nine->accusations, 2);
  EXPECT_NEAR(nine->since_s, 8.0, 0.1);
}

// Served out by the clock of messages, and not taken up a second time.
TEST(PriorityRestart, ARevokedSenderIsReleasedWhenItsTimeIsOver) {
  Scene scene;
  scene.perception.RestoreTrust(
      {{.sender = 1, .state = TrustState::kRevoked, .accusations = 1, .since_s = 59.0}});
  scene.cars = {OncomingCar()};
  scene.Run(8.0, [&] { scene.Honest(1); });
  EXPECT_EQ(scene.Priority().size(), 1u);
}

}  // namespace
}  // namespace v2vouch
