// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/motion_check.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

const MessageCheckConfig kConfig;

TEST(InnovationCheck, JudgesTheMeanOfTen) {
  InnovationCheck check;
  for (int i = 0; i < 9; ++i) EXPECT_FALSE(check.Judge(30.0, 4, 0.1, kConfig));
  const auto finding = check.Judge(30.0, 4, 0.1, kConfig);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->check, Check::kOwnMotion);
  EXPECT_EQ(finding->severity, Verdict::kWithdraw);
  EXPECT_NEAR(finding->value, 30.0 / 1.16, 1e-3);  // 1 + (0.1 / 0.25)^2.
}

TEST(InnovationCheck, NoTwoMessagesReachTheLimit) {
  InnovationCheck check;
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(check.Judge(i % 10 < 2 ? 1e9 : 4.0, 4, 0.1, kConfig)) << i;
  }
}

TEST(InnovationCheck, FewMessagesProveLess) {
  InnovationCheck check;
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(check.Judge(100.0, 4, 1.0, kConfig)) << i;
}

TEST(InnovationCheck, SilencesDoNotCount) {
  InnovationCheck check;
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(check.Judge(std::nullopt, 4, 0.1, kConfig));
}

class JumpCheckTest : public ::testing::Test {
 protected:
  // Eastward at 10 m/s, ten messages a second, displaced by `aside_m`.
  std::optional<Finding> Hear(double aside_m, double dt_s = 0.1) {
    time_s_ += dt_s;
    return check_.Judge({time_s_, {10.0 * time_s_, aside_m}, {10.0, 0.0}}, kConfig);
  }
  JumpCheck check_;
  double time_s_ = 0.0;
};

TEST_F(JumpCheckTest, AJumpIsWithdrawnOnce) {
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(Hear(0.0));
  const auto finding = Hear(30.0);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->check, Check::kPositionJump);
  EXPECT_EQ(finding->severity, Verdict::kWithdraw);
  EXPECT_NEAR(finding->value, 30.0, 1e-9);
  EXPECT_EQ(finding->limit, 8.0);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(Hear(30.0));
}

TEST_F(JumpCheckTest, SevenMetresAreNone) {
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(Hear(i % 2 == 0 ? 7.0 : 0.0));
}

// A lie of 10 m is found whatever the noise; an honest receiver that knows no better is not accused
// for jumps of 9 m, however many.
TEST_F(JumpCheckTest, NineMetresAccuseNobody) {
  EXPECT_FALSE(Hear(0.0));
  for (int i = 1; i < 20; ++i) {
    const auto finding = Hear(9.0 * i);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->severity, Verdict::kWithdraw);
  }
}

TEST_F(JumpCheckTest, ThreeInFiveMessagesAccuse) {
  EXPECT_FALSE(Hear(0.0));
  EXPECT_EQ(Hear(40.0)->severity, Verdict::kWithdraw);
  EXPECT_EQ(Hear(-25.0)->severity, Verdict::kWithdraw);
  EXPECT_FALSE(Hear(-25.0));
  EXPECT_EQ(Hear(90.0)->severity, Verdict::kAccuse);
}

// Somebody else sends under the identity of an honest car, 15 m beside it: which of the two lies
// cannot be told from the messages, so neither is accused.
TEST_F(JumpCheckTest, TwoPlacesInTurnsAreNoAccusation) {
  EXPECT_FALSE(Hear(0.0));
  int two_places = 0;
  for (int i = 0; i < 50; ++i) {
    const auto finding = Hear(i % 2 == 0 ? 15.0 : 0.0);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->severity, Verdict::kWithdraw);
    two_places += finding->check == Check::kTwoPlaces ? 1 : 0;
  }
  EXPECT_EQ(two_places, 49);  // The first could still have been a jump.
}

TEST_F(JumpCheckTest, ALongSilenceExplainsALongWay) {
  EXPECT_FALSE(Hear(0.0));
  EXPECT_FALSE(Hear(100.0, 4.5));
  EXPECT_TRUE(Hear(400.0, 4.5));  // 66 m/s sideways.
}

TEST_F(JumpCheckTest, AClaimedTimeThatStandsStillDoesNotHideAJump) {
  EXPECT_FALSE(Hear(0.0));
  EXPECT_TRUE(Hear(50.0, 0.0));
  EXPECT_TRUE(Hear(0.0, -0.5));
}

TEST(SpeedStepCheck, TwoMessagesMakeAStep) {
  SpeedStepCheck check;
  for (int i = -2; i < 2; ++i) EXPECT_FALSE(check.Judge(0.1 * i, 10.0, kConfig));
  EXPECT_FALSE(check.Judge(0.2, 0.0, kConfig));
  const auto finding = check.Judge(0.3, 0.0, kConfig);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->check, Check::kImplausibleMotion);
  EXPECT_NEAR(finding->value, -100.0, 1e-6);
  EXPECT_EQ(finding->limit, 12.0);
  EXPECT_FALSE(check.Judge(0.4, 0.0, kConfig));
}

TEST(SpeedStepCheck, OneOddMessageIsNone) {
  SpeedStepCheck check;
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(check.Judge(0.1 * i, i == 7 ? 0.0 : 10.0, kConfig));
}

TEST(SpeedStepCheck, HardBrakingIsHonest) {
  for (const double dt_s : {0.05, 0.1, 0.5, 1.0}) {
    SpeedStepCheck check;
    for (double t = 0.0; t < 4.0; t += dt_s) {
      EXPECT_FALSE(check.Judge(t, std::max(0.0, 25.0 - 10.0 * t), kConfig)) << dt_s;
    }
  }
}

}  // namespace
}  // namespace v2vouch
