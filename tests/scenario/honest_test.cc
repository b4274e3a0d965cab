// SPDX-License-Identifier: Apache-2.0
// Nobody lies: nobody is withdrawn. And what excuses the honest excuses no liar.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/scenario/recording.h"

namespace v2vouch::testing {
namespace {

struct Drive {
  const char* scenario;
  std::uint64_t seed;
};

class NobodyLiesIn : public ::testing::TestWithParam<Drive> {};

// As a car slips behind a waiting lorry the sensors measure an ever smaller part of it, which drags
// its LOCAL track across by up to 3 m and turns it by up to 30 degrees.
TEST_P(NobodyLiesIn, NobodyIsWithdrawnAsItSlipsBehindALorry) {
  const Recording recording = Record(GetParam().scenario, GetParam().seed);
  ASSERT_FALSE(recording.empty());
  const Outcome outcome = Perceive(recording);
  EXPECT_THAT(outcome.reports, ::testing::IsEmpty());
  EXPECT_GE(outcome.vouched.size(), 2u);
  // ... but not its place in PRIORITY while it is hidden.
  ASSERT_GT(outcome.hidden_entries, 20);
  EXPECT_LT(std::sqrt(outcome.hidden_error_m2 / outcome.hidden_entries), 1.2);
}

INSTANTIATE_TEST_SUITE_P(Shipped, NobodyLiesIn,
                         ::testing::Values(Drive{"occlusion", 1}, Drive{"occlusion", 5},
                                           Drive{"occlusion", 9}),
                         [](const auto& param) {
                           return std::string(param.param.scenario) +
                                  std::to_string(param.param.seed);
                         });

// It speeds up by 4.5 m/s while it is hidden, and comes back 7 m ahead of where it would be.
TEST(NobodyLies, ACarThatSpedUpBehindALorryComesBackAsTheSameVehicle) {
  const Recording recording = Record("left_turn", 1);
  ASSERT_FALSE(recording.empty());
  const Outcome outcome = Perceive(recording);
  EXPECT_THAT(outcome.reports, ::testing::IsEmpty());
  EXPECT_GE(outcome.priority_ids.size(), 4u);
  for (const auto& [sender, ids] : outcome.priority_ids) EXPECT_EQ(ids.size(), 1u) << sender;
}

// A claim that drifts aside soon lies behind something else. Only a vehicle that the sensors
// measure where its sender has it is excused for the part of it that is hidden there.
TEST(SomebodyLies, AClaimThatDriftsBehindSomethingElseIsFoundOut) {
  const Recording recording = RecordWith("campaign_highway", 964, "A07_lateral_0.5mps", 20);
  ASSERT_FALSE(recording.empty());
  const Outcome outcome = Perceive(recording);
  EXPECT_THAT(outcome.reports, ::testing::Contains("residual_drift"));
}

}  // namespace
}  // namespace v2vouch::testing
