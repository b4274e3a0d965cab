// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/priority/priority_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/daemon/v2v/priority/hidden_case.h"

namespace v2vouch {
namespace {

constexpr double kDt_s = 0.05;

Timestamp At(int step) { return FromMicros(1'000'000) + FromSeconds(kDt_s * step); }

TEST(PriorityFilter, HiddenVehicleStaysWithinItsTarget) {
  const HiddenCaseResult result = RunHiddenCase({.runs = 50});
  std::printf(
      "seen %.3f m (ANEES %.2f; LOCAL %.3f m), hidden %.3f m (ANEES %.2f), after 4 s %.3f m\n",
      result.seen.rms(), result.seen.anees(), result.local_seen.rms(), result.hidden.rms(),
      result.hidden.anees(), result.at_end.rms());
  EXPECT_LE(result.hidden.rms(), 0.6);
  EXPECT_LE(result.hidden.anees(), 3.0);
  EXPECT_LE(result.seen.anees(), 3.0);
  EXPECT_LE(result.seen.rms(), 1.02 * result.local_seen.rms());  // As good as LOCAL while seen.
}

TEST(PriorityFilter, CorrelatedGnssErrorIsCoveredByTheCovariance) {
  const HiddenCaseResult result = RunHiddenCase({.runs = 50, .correlated_m = 0.5});
  std::printf("with 0.5 m, 30 s: hidden %.3f m (ANEES %.2f), after 4 s %.3f m\n",
              result.hidden.rms(), result.hidden.anees(), result.at_end.rms());
  EXPECT_LE(result.hidden.rms(), 0.6);
  EXPECT_LE(result.hidden.anees(), 3.0);
}

// The harder case: reflections anywhere on the faces of a car of unknown size. What the sensors
// saw and how long it was is LOCAL's own estimate.
TEST(PriorityFilter, UnknownExtentIsCoveredByTheCovariance) {
  const HiddenCaseResult result =
      RunHiddenCase({.target = HiddenCaseTarget::kExtentUnknown, .runs = 20});
  std::printf("extent unknown: seen %.3f m, hidden %.3f m (ANEES %.2f), after 4 s %.3f m\n",
              result.seen.rms(), result.hidden.rms(), result.hidden.anees(), result.at_end.rms());
  EXPECT_EQ(result.lost, 0);
  EXPECT_LE(result.hidden.rms(), 0.9);
  EXPECT_LE(result.hidden.anees(), 3.0);
}

TEST(PriorityFilter, ClaimsAreWhatMakesTheDifferenceWhileHidden) {
  const auto at_end = [](bool with_claims) {
    return RunHiddenCase({.runs = 20, .has_claims_while_hidden = with_claims}).at_end.rms();
  };
  EXPECT_GT(at_end(false), 2.0 * at_end(true));
}

PriorityFilter Standing(const PriorityFilterConfig& config) {
  KinematicState start;
  start.mean << 30.0, 0.0, 0.0, 10.0, 0.0, 0.0;
  start.covariance.diagonal() << 0.04, 0.04, 0.001, 0.02, 0.001, 0.05;
  return {start, At(0), Eigen::Vector2d::Zero(), 0.09 * Eigen::Matrix2d::Identity(), 0.005, config};
}

ClaimInOdometry ClaimOf(const PriorityFilter& filter) {
  const KinematicState state = filter.kinematics();
  ClaimInOdometry claim;
  claim.stamp = filter.stamp();
  claim.p_O = state.mean.head<2>() + filter.bias();
  claim.yaw_rad = state.mean[kYaw];
  claim.speed_mps = state.mean[kSpeed];
  return claim;
}

TEST(PriorityFilter, OutlierIsNotUsed) {
  const PriorityFilterConfig config;
  PriorityFilter filter = Standing(config);
  const auto before = filter.mean();
  ClaimInOdometry claim = ClaimOf(filter);
  claim.p_O.y() += 8.0;
  const ClaimFit fit = filter.Update(claim, config);
  EXPECT_FALSE(fit.is_used);
  EXPECT_GT(fit.position_nis, config.position_gate);
  EXPECT_EQ(filter.mean(), before);
}

TEST(PriorityFilter, FalseBrakingIsNotFollowed) {
  const PriorityFilterConfig config;
  PriorityFilter filter = Standing(config);
  ClaimInOdometry claim = ClaimOf(filter);
  claim.accel_mps2 = -6.0;
  filter.Update(claim, config);
  EXPECT_NEAR(filter.kinematics().mean[kAccel], 0.0, 1e-9);
}

TEST(PriorityFilter, ReversingCarMayBeToldFromEitherEnd) {
  const PriorityFilterConfig config;
  PriorityFilter filter = Standing(config);
  ClaimInOdometry claim = ClaimOf(filter);
  claim.yaw_rad = kPi;
  claim.speed_mps = -claim.speed_mps;
  const ClaimFit fit = filter.Update(claim, config);
  EXPECT_TRUE(fit.is_used && fit.is_velocity_used);
  EXPECT_NEAR(filter.kinematics().mean[kSpeed], -10.0, 0.2);
}

TEST(PriorityFilter, PredictionInOneStepOrManyAgrees) {
  const PriorityFilterConfig config;
  PriorityFilter once = Standing(config);
  PriorityFilter often = once;
  once.PredictTo(At(20), config);
  for (int step = 2; step <= 20; step += 2) often.PredictTo(At(step), config);
  EXPECT_LT((once.mean() - often.mean()).norm(), 1e-6);
  EXPECT_LT((once.covariance() - often.covariance()).norm(), 1e-6);
}

TEST(PriorityFilter, BiasNeverExceedsItsCap) {
  PriorityFilterConfig config;
  config.position_gate = 100.0;
  PriorityFilter filter = Standing(config);
  for (int step = 1; step < 400; ++step) {
    filter.PredictTo(At(step), config);
    ClaimInOdometry claim = ClaimOf(filter);
    claim.p_O.y() += 2.0;
    filter.Update(claim, config);
    ASSERT_LE(filter.bias().norm(), config.max_bias_m + 1e-9);
  }
}

TEST(PriorityFilter, ADayWithoutAnyWordIsPredictedAtOnce) {
  const PriorityFilterConfig config;
  PriorityFilter filter = Standing(config);
  filter.PredictTo(At(0) + FromSeconds(86400.0), config);
  const KinematicState state = filter.kinematics();
  EXPECT_TRUE(state.mean.allFinite());
  EXPECT_TRUE(state.covariance.allFinite());
  EXPECT_GT(std::sqrt(state.covariance(kX, kX)), 1e5);
}

}  // namespace
}  // namespace v2vouch
