// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/content_check.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

const MessageCheckConfig kConfig;

TEST(DelayCheck, JudgesTheMedianOfTenMessages) {
  DelayCheck check;
  for (int i = 0; i < 9; ++i) EXPECT_FALSE(check.Judge(1.2, kConfig)) << i;
  const auto finding = check.Judge(1.2, kConfig);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->check, Check::kLateMessages);
  EXPECT_EQ(finding->severity, Verdict::kWithdraw);
  EXPECT_NEAR(finding->value, 1.2, 1e-6);
  EXPECT_EQ(finding->limit, 0.8);
}

TEST(DelayCheck, SparesASenderOfWhichSomeMessagesAreLate) {
  DelayCheck check;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(check.Judge(i % 5 < 2 ? 1.4 : 0.2, kConfig)) << i;
}

TEST(DelayCheck, ForgivesOnceTheMessagesAreFreshAgain) {
  DelayCheck check;
  for (int i = 0; i < 10; ++i) (void)check.Judge(1.2, kConfig);
  for (int i = 0; i < 5; ++i) (void)check.Judge(0.1, kConfig);
  EXPECT_FALSE(check.Judge(0.1, kConfig));
}

TEST(SizeCheck, TellsAChangeOnceAndEveryFurtherOne) {
  SizeCheck check;
  EXPECT_FALSE(check.Judge(4.6, 1.8, kConfig));
  EXPECT_FALSE(check.Judge(4.6, 1.8, kConfig));
  const auto finding = check.Judge(13.8, 1.8, kConfig);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->check, Check::kSizeChange);
  EXPECT_NEAR(finding->value, 9.2, 1e-9);
  EXPECT_EQ(finding->limit, 0.3);
  EXPECT_FALSE(check.Judge(13.8, 1.8, kConfig));  // A correction is not repeated.
  EXPECT_TRUE(check.Judge(4.6, 1.8, kConfig));
}

TEST(SizeCheck, WidthsAreJudgedByTheirShare) {
  SizeCheck check;
  EXPECT_FALSE(check.Judge(4.6, 1.8, kConfig));
  EXPECT_FALSE(check.Judge(4.6, 1.95, kConfig));
  EXPECT_TRUE(check.Judge(4.6, 2.2, kConfig));
}

TEST(SizeCheck, AMissingSizeIsNoChange) {
  SizeCheck check;
  EXPECT_FALSE(check.Judge(4.6, 1.8, kConfig));
  EXPECT_FALSE(check.Judge(std::nullopt, std::nullopt, kConfig));
  EXPECT_FALSE(check.Judge(4.6, 1.8, kConfig));
  EXPECT_TRUE(check.Judge(5.2, 1.8, kConfig));
}

TEST(ImplausibleCheck, TakesThreeOfTen) {
  ImplausibleCheck check;
  const auto hear = [&check](bool is_implausible) {
    check.OnMessage(is_implausible);
    return check.Judge(kConfig);
  };
  EXPECT_FALSE(hear(true));
  for (int i = 0; i < 9; ++i) EXPECT_FALSE(hear(false));
  EXPECT_FALSE(hear(true));  // The first has left the window.
  EXPECT_FALSE(hear(true));
  const auto finding = hear(true);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->check, Check::kImplausible);
  EXPECT_EQ(finding->value, 3.0);
}

}  // namespace
}  // namespace v2vouch
