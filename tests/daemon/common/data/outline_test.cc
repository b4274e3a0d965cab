// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/data/outline.h"

#include <gtest/gtest.h>

#include <vector>

namespace v2vouch {
namespace {

TEST(KeepOutline, LeavesTheStrongAndTheNearest) {
  std::vector<OutlineReturn> returns = {
      {21.7, 0.00, 20.0}, {20.0, 0.01, 42.0}, {20.2, -0.03, 45.0}, {22.0, -0.03, 44.0}};
  returns.resize(KeepOutline(returns));
  ASSERT_EQ(returns.size(), 2U);
  EXPECT_DOUBLE_EQ(returns[0].range_m, 20.2);  // Strongest first; 22.0 m lies behind it.
  EXPECT_DOUBLE_EQ(returns[1].range_m, 20.0);
}

TEST(KeepOutline, AFlankSeenAslantIsKept) {
  // Deeper, but each at a bearing of its own.
  std::vector<OutlineReturn> returns = {{20.0, 0.10, 0.0}, {21.0, 0.05, 0.0}, {22.0, 0.00, 0.0}};
  returns.resize(KeepOutline(returns));
  EXPECT_EQ(returns.size(), 3U);
}

TEST(KeepOutline, WithoutStrengthTheNearestAtEachBearingStay) {
  std::vector<OutlineReturn> returns = {{20.0, 0.0, 0.0}, {23.0, 0.001, 0.0}, {20.1, 0.04, 0.0}};
  returns.resize(KeepOutline(returns));
  ASSERT_EQ(returns.size(), 2U);
  EXPECT_DOUBLE_EQ(returns[0].range_m, 20.0);
  EXPECT_DOUBLE_EQ(returns[1].range_m, 20.1);
}

TEST(KeepOutline, OneOrNoneIsLeftAlone) {
  std::vector<OutlineReturn> none;
  EXPECT_EQ(KeepOutline(none), 0U);
  std::vector<OutlineReturn> one = {{5.0, 0.0, -3.0}};
  EXPECT_EQ(KeepOutline(one), 1U);
}

}  // namespace
}  // namespace v2vouch
