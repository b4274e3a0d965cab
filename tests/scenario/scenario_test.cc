// SPDX-License-Identifier: Apache-2.0
// The rules that may never break, on the shipped scenarios: each edits a good recording and says
// what must change and what must not.
#include <gtest/gtest.h>

#include "tests/scenario/recording.h"

namespace v2vouch::testing {
namespace {

class ShippedScenario : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    recording_ = Record(GetParam(), 101);
    ASSERT_FALSE(recording_.empty());
    good_ = Perceive(recording_);
  }
  Recording recording_;
  Outcome good_;
};

TEST_P(ShippedScenario, GivesFiniteListsAndTheSameBitsEveryTime) {
  EXPECT_GT(good_.local_tracks, 1000);
  EXPECT_GT(good_.priority_tracks, 1000);
  EXPECT_EQ(good_.not_finite, 0);
  const Outcome again = Perceive(recording_);
  EXPECT_EQ(good_.digest_local, again.digest_local);
  EXPECT_EQ(good_.digest_priority, again.digest_priority);
}

TEST_P(ShippedScenario, LocalIsTheSameWithoutRadioWithoutTruthAndWithAGnssJump) {
  const Outcome silent = Perceive(Without(recording_, "BSM"));
  EXPECT_EQ(good_.digest_local, silent.digest_local);
  EXPECT_EQ(silent.priority_tracks, 0);

  const Outcome blind = Perceive(Without(recording_, "TRUTH"));
  EXPECT_EQ(good_.digest_local, blind.digest_local);
  EXPECT_EQ(good_.digest_priority, blind.digest_priority);

  const Outcome jumped = Perceive(WithGnssJump(recording_, 12.0, 50.0));
  EXPECT_EQ(good_.digest_local, jumped.digest_local);
  EXPECT_NE(good_.digest_priority, jumped.digest_priority);
}

TEST_P(ShippedScenario, AGhostNeverAppears) {
  const std::vector<Ghost> ghosts = {
      {0xEE000001, [](double) { return std::pair(15.0, 0.0); }},
      {0xEE000002, [](double) { return std::pair(30.0, 0.0); }},
      {0xEE000003, [](double) { return std::pair(60.0, 3.5); }},
      // Comes in from ahead, as if braking into us.
      {0xEE000004, [](double t) { return std::pair(std::max(20.0, 200.0 - 8.0 * t), 0.0); }},
      // Waits where no sensor looks, then slips into view.
      {0xEE000005, [](double t) { return std::pair(-40.0 + 3.0 * t, -6.0); }},
      // Off the road, behind whatever stands there.
      {0xEE000006, [](double) { return std::pair(40.0, 25.0); }},
      {0xEE000007, [](double) { return std::pair(25.0, -20.0); }},
  };
  const Outcome outcome = Perceive(WithGhosts(recording_, ghosts));
  EXPECT_EQ(good_.digest_local, outcome.digest_local);
  for (const Ghost& ghost : ghosts) EXPECT_EQ(outcome.vouched.count(ghost.id), 0u) << ghost.id;
  EXPECT_FALSE(outcome.vouched.empty()) << "honest senders are served beside the ghosts";
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScenario, ::testing::Values("left_turn", "urban", "highway"),
                         [](const auto& param) { return std::string(param.param); });

}  // namespace
}  // namespace v2vouch::testing
