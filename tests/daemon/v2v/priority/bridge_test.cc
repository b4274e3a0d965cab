// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/priority/bridge.h"

#include <gtest/gtest.h>

#include "daemon/v2v/priority/priority_vehicle.h"

namespace v2vouch {
namespace {

const BridgeConfig kConfig;

TEST(BridgeBudget, GrowsWithCoObservationBetweenItsBounds) {
  EXPECT_DOUBLE_EQ(BridgeBudget_s(1.5, kConfig), 4.5);
  EXPECT_DOUBLE_EQ(BridgeBudget_s(4.0, kConfig), 6.0);
  EXPECT_DOUBLE_EQ(BridgeBudget_s(100.0, kConfig), 10.0);
}

TEST(IsReachable, HonestTurnStaysInsideAndSidewaysFlightDoesNot) {
  KinematicState seen;
  seen.mean[kSpeed] = 10.0;
  seen.covariance = StateMatrix::Identity() * 1e-8;
  const Coast coast(seen, FromMicros(0));
  // 3 m/s^2 across for 2 s = 6 m; the set allows 1.5 + 6.
  EXPECT_TRUE(coast.Reaches({0.0, 6.0}, 2.0, kConfig));
  EXPECT_FALSE(coast.Reaches({0.0, 8.0}, 2.0, kConfig));
  EXPECT_FALSE(coast.Reaches({0.0, 2.5}, 0.4, kConfig));
}

TEST(IsReachable, DoubtOfTheDirectionWidensTheSet) {
  KinematicState seen;
  seen.mean[kSpeed] = 10.0;
  seen.covariance = StateMatrix::Identity() * 1e-8;
  seen.covariance(kYaw, kYaw) = 0.1 * 0.1;
  // 2 sigma x 10 m/s x 1 s = 2 m more than 3 m across.
  const Coast coast(seen, FromMicros(0));
  EXPECT_TRUE(coast.Reaches({0.0, 4.9}, 1.0, kConfig));
  EXPECT_FALSE(coast.Reaches({0.0, 5.1}, 1.0, kConfig));
}

// What a hidden liar can do is bounded, however long its vehicle stays hidden.
TEST(IsReachable, NothingIsBeyondTheMost) {
  KinematicState seen;
  seen.mean[kSpeed] = 10.0;
  seen.covariance = StateMatrix::Identity();
  const Coast coast(seen, FromMicros(0));
  for (const double elapsed_s : {3.0, 5.0, 10.0}) {
    EXPECT_TRUE(coast.Reaches({0.0, kConfig.reach_most_m - 0.1}, elapsed_s, kConfig)) << elapsed_s;
    EXPECT_FALSE(coast.Reaches({0.0, kConfig.reach_most_m + 0.1}, elapsed_s, kConfig)) << elapsed_s;
    EXPECT_FALSE(coast.Reaches({kConfig.reach_most_m + 0.1, 0.0}, elapsed_s, kConfig)) << elapsed_s;
  }
}

// A car drives straight on behind a lorry; what the sensors saw of it last, a sliver, had dragged
// LOCAL's direction by 25 degrees, the fused state not.
TEST(CanReach, StraightOnIsInsideWhenTheLastLooksWereOfASliver) {
  KinematicState fused;
  fused.mean[kSpeed] = 6.6;
  fused.covariance = StateMatrix::Identity() * 1e-3;
  KinematicState sliver = fused;
  sliver.mean[kY] = 1.3;
  sliver.mean[kYaw] = FromDegrees(25.0);
  const Timestamp lost = FromMicros(0);
  const PriorityFilterConfig filter;
  for (const double t_s : {0.5, 1.0, 2.0, 4.0}) {
    PriorityVehicle vehicle{.filter = PriorityFilter(fused, lost, Eigen::Vector2d::Zero(),
                                                     Eigen::Matrix2d::Identity(), 0.005, filter)};
    vehicle.last_support = lost;
    vehicle.coast = vehicle.agreed = Coast(sliver, lost);
    const Timestamp now = lost + FromSeconds(t_s);
    vehicle.PredictTo(now, filter);
    const Eigen::Vector2d straight_on(6.6 * t_s, 0.0);
    EXPECT_FALSE(vehicle.CanReach(straight_on, now, kConfig) && t_s <= 1.0) << t_s;
    vehicle.agreed = Coast(fused, lost);
    vehicle.PredictTo(now, filter);
    EXPECT_TRUE(vehicle.CanReach(straight_on, now, kConfig)) << t_s;
    EXPECT_FALSE(vehicle.CanReach({straight_on.x(), -4.0 - 2.0 * t_s * t_s}, now, kConfig)) << t_s;
  }
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

TEST(EmptyPlace, OnlyARunOfClearLooksCounts) {
  EmptyPlace place;
  for (int i = 0; i < 200; ++i) {  // 0.45 s of clear view, then something in the way, for 10 s.
    const Timestamp now = FromMicros(0) + FromSeconds(0.05 * i);
    if (i % 10 == 9) {
      place.OnCovered();
    } else {
      place.OnMiss(now, 0.95, kConfig);
    }
    ASSERT_GT(place.log_ratio(), kConfig.empty_log_ratio) << i;
  }
}

TEST(WidenPosition, RaisesWhatIsLessAndLeavesWhatIsMore) {
  KinematicState state;
  state.covariance = StateMatrix::Identity() * 0.01;
  state.covariance(kX, kX) = 1.0;
  PriorityFilter filter(state, FromMicros(0), Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity(),
                        0.005, PriorityFilterConfig{});
  const Eigen::Matrix2d least = Eigen::Vector2d(0.25, 0.25).asDiagonal();
  EXPECT_NEAR(
      (filter.LackOf(least) - Eigen::Matrix2d(Eigen::Vector2d(0.0, 0.24).asDiagonal())).norm(), 0.0,
      1e-12);
  filter.WidenPosition(least);
  EXPECT_NEAR(filter.covariance()(kX, kX), 1.0, 1e-12);
  EXPECT_NEAR(filter.covariance()(kY, kY), 0.25, 1e-12);
  EXPECT_NEAR(filter.LackOf(least).norm(), 0.0, 1e-12);
  EXPECT_TRUE(filter.is_healthy());
}

TEST(PriorityId, IsAFunctionOfTheLocalTrackAndFitsTheWire) {
  EXPECT_EQ(PriorityId(42, 0), PriorityId(42, 0));
  EXPECT_NE(PriorityId(42, 0), PriorityId(43, 0));
  EXPECT_NE(PriorityId(42, 0), PriorityId(42, 1));
  EXPECT_GT(static_cast<std::int64_t>(PriorityId(~0ULL, 0)), 0);
}

}  // namespace
}  // namespace v2vouch
