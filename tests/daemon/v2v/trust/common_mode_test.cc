// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/common_mode.h"

#include <gtest/gtest.h>

#include <vector>

namespace v2vouch {
namespace {

const CommonModeConfig kConfig;

CommonMode Of(const std::vector<Eigen::Vector2d>& residuals) {
  std::vector<SenderResidual> senders;
  for (const Eigen::Vector2d& residual : residuals) {
    senders.push_back({static_cast<SenderId>(senders.size() + 1), residual});
  }
  return CommonMode(senders, kConfig);
}

TEST(CommonMode, ThreeSendersShiftedAlikeBlameTheEgo) {
  const CommonMode common = Of({{6.0, 1.0}, {6.5, 0.4}, {5.6, 1.2}});
  EXPECT_TRUE(common.is_shifted());
  EXPECT_NEAR(common.shift_O().x(), 6.03, 0.01);
  EXPECT_FALSE(Of({{6.0, 1.0}, {6.5, 0.4}}).is_shifted()) << "two may be two liars";
  EXPECT_FALSE(Of({{6.0, 1.0}, {-6.5, 0.4}, {0.0, 6.0}}).is_shifted()) << "each its own way";
  EXPECT_FALSE(Of({{1.0, 0.2}, {0.8, 0.0}, {1.4, 0.5}}).is_shifted()) << "no more than usual";
}

TEST(CommonMode, AMinorityBlamesNobodyButItself) {
  EXPECT_FALSE(
      Of({{6.0, 1.0}, {6.5, 0.4}, {5.6, 1.2}, {0.1, 0.0}, {0.3, 0.2}, {-0.4, 0.1}}).is_shifted());
}

TEST(CommonMode, OneLiarAmongShiftedHonestSendersDoesNotHideTheShift) {
  const CommonMode common = Of({{3.0, 0.0}, {3.4, 0.2}, {2.9, -0.3}, {-12.0, 4.0}});
  EXPECT_TRUE(common.is_shifted());
  EXPECT_NEAR(common.shift_O().x(), 3.1, 0.01);
}

TEST(CommonMode, AnAccusationNeedsAWitness) {
  EXPECT_FALSE(Of({{9.0, 0.0}}).HasWitnessAgainst(1));
  const CommonMode two = Of({{9.0, 0.0}, {0.5, 0.0}});
  EXPECT_TRUE(two.HasWitnessAgainst(1));
  EXPECT_FALSE(two.HasWitnessAgainst(2)) << "nobody vouches for himself";
  EXPECT_FALSE(CommonMode().HasWitnessAgainst(1));
}

}  // namespace
}  // namespace v2vouch
