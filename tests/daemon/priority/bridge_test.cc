// SPDX-License-Identifier: Apache-2.0
#include "daemon/priority/bridge.h"

#include <gtest/gtest.h>

#include "daemon/priority/priority_vehicle.h"

namespace v2vouch {
namespace {

const BridgeConfig kConfig;

TEST(BridgeBudget, GrowsWithCoObservationBetweenItsBounds) {
  EXPECT_DOUBLE_EQ(BridgeBudget_s(1.5, kConfig), 4.5);
  EXPECT_DOUBLE_EQ(BridgeBudget_s(4.0, kConfig), 6.0);
  EXPECT_DOUBLE_EQ(BridgeBudget_s(100.0, kConfig), 10.0);
}

TEST(IsReachable, HonestTurnStaysInsideAndSidewaysFlightDoesNot) {
  KinematicState coast;
  coast.mean[kSpeed] = 10.0;
  // 3 m/s^2 across for 2 s = 6 m; the set allows 1.5 + 6.
  EXPECT_TRUE(IsReachable(coast, 2.0, {0.0, 6.0}, kConfig));
  EXPECT_FALSE(IsReachable(coast, 2.0, {0.0, 8.0}, kConfig));
  EXPECT_FALSE(IsReachable(coast, 0.4, {0.0, 2.5}, kConfig));
}

TEST(EmptyPlace, AboutOneSecondOfClearViewIsEnough) {
  EmptyPlace place;
  double t = 0.0;
  while (place.log_ratio() > kConfig.empty_log_ratio && t < 5.0) {
    t += 0.05;
    place.OnMiss(FromMicros(0) + FromSeconds(t), 0.9, kConfig);
  }
  EXPECT_LE(t, 1.0);
  EXPECT_GE(t, 0.3);  // Never from one look.
  place.OnHit();
  EXPECT_EQ(place.log_ratio(), 0.0);
}

TEST(PriorityId, IsAFunctionOfTheLocalTrackAndFitsTheWire) {
  EXPECT_EQ(PriorityId(42, 0), PriorityId(42, 0));
  EXPECT_NE(PriorityId(42, 0), PriorityId(43, 0));
  EXPECT_NE(PriorityId(42, 0), PriorityId(42, 1));
  EXPECT_GT(static_cast<std::int64_t>(PriorityId(~0ULL, 0)), 0);
}

}  // namespace
}  // namespace v2vouch
