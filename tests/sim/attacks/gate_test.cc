// SPDX-License-Identifier: Apache-2.0
#include "sim/attacks/gate.h"

#include <gtest/gtest.h>

namespace v2vouch::sim {
namespace {

Circumstances At(double time_s, double ego_mps = 10.0, int spell = 0) {
  return {time_s, time_s, spell, ego_mps, {}, nullptr};
}

TEST(Gate, OpensAtStartAndClosesAtStop) {
  Gate gate({.start_s = 5.0, .stop_s = 8.0});
  EXPECT_FALSE(gate.Update(At(4.9)));
  EXPECT_TRUE(gate.Update(At(5.0)));
  EXPECT_TRUE(gate.Update(At(7.5)));
  EXPECT_EQ(gate.number(), 1);
  EXPECT_NEAR(gate.elapsed_s(), 2.5, 1e-9);
  EXPECT_FALSE(gate.Update(At(8.0)));
}

TEST(Gate, WaitsForTheEgoToDriveButNotTwice) {
  Gate gate({.ego_above_mps = 5.0});
  EXPECT_FALSE(gate.Update(At(1.0, 4.0)));
  EXPECT_TRUE(gate.Update(At(2.0, 6.0)));
  EXPECT_TRUE(gate.Update(At(3.0, 0.0)));
}

TEST(Gate, RestsAndBeginsEachSpellAnew) {
  Gate gate({.start_s = 1.0, .active_s = 2.0, .pause_s = 6.0});
  EXPECT_TRUE(gate.Update(At(1.0)));
  EXPECT_TRUE(gate.Update(At(2.9)));
  EXPECT_FALSE(gate.Update(At(3.1)));
  EXPECT_FALSE(gate.Update(At(8.9)));
  EXPECT_TRUE(gate.Update(At(9.5)));
  EXPECT_EQ(gate.number(), 0);
  EXPECT_NEAR(gate.elapsed_s(), 0.5, 1e-9);
}

TEST(Gate, ABlocksGateBeginsAnewWithTheAttacksSpell) {
  Gate gate(WhenSpec{});
  EXPECT_TRUE(gate.Update(At(1.0)));
  EXPECT_TRUE(gate.Update(At(4.0)));
  EXPECT_NEAR(gate.elapsed_s(), 3.0, 1e-9);
  EXPECT_TRUE(gate.Update(At(9.0, 10.0, 1)));
  EXPECT_NEAR(gate.elapsed_s(), 0.0, 1e-9);
}

TEST(Gate, StaysShutWhereNobodyCouldBeInView) {
  Gate gate({.after_in_view_s = 1.0});
  EXPECT_FALSE(gate.Update(At(30.0)));
}

}  // namespace
}  // namespace v2vouch::sim
