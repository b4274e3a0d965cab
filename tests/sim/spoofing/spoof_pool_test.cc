// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/spoof_pool.h"

#include <gtest/gtest.h>

#include <cmath>

namespace v2vouch::evaluation {
namespace {

TEST(PoolF1, PoolsCountsAndItsIntervalHoldsTheEstimate) {
  std::vector<Confusion> runs;
  for (int i = 0; i < 20; ++i) runs.push_back({90 + i % 3, i % 2, 10 - i % 3, 500});
  const PooledF1 pooled = PoolF1(runs);
  EXPECT_EQ(pooled.counts.true_positive, 1819);
  EXPECT_NEAR(*pooled.f1, 2.0 * 1819 / (2.0 * 1819 + 10 + 181), 1e-12);
  EXPECT_LT(*pooled.low, *pooled.f1);
  EXPECT_GT(*pooled.high, *pooled.f1);
  EXPECT_LT(*pooled.high - *pooled.low, 0.02);
  EXPECT_EQ(*PoolF1(runs).low, *pooled.low);  // The same draws each time.
}

TEST(PoolF1, OneRunInTwentyThatFailsWidensTheInterval) {
  std::vector<Confusion> runs(20, Confusion{100, 0, 0, 100});
  EXPECT_EQ(*PoolF1(runs).low, 1.0);
  runs[7] = {0, 0, 100, 100};
  const PooledF1 pooled = PoolF1(runs);
  EXPECT_NEAR(*pooled.f1, 2.0 * 1900 / (2.0 * 1900 + 100), 1e-12);
  EXPECT_LT(*pooled.low, 0.95);
  EXPECT_EQ(*pooled.high, 1.0);
}

TEST(PoolF1, NothingFalseGivesNothing) {
  const std::vector<Confusion> runs(3, Confusion{0, 1, 0, 100});
  EXPECT_FALSE(PoolF1(runs).f1);
  EXPECT_FALSE(PoolF1({}).f1);
}

TEST(CensoredTimes, AreInfinitelyLate) {
  CensoredTimes times{{3.0, 1.0, 2.0}, 1};
  EXPECT_EQ(times.Percentile(0.5), 2.0);
  EXPECT_EQ(times.Percentile(0.75), 3.0);
  EXPECT_FALSE(times.Percentile(0.95));
  EXPECT_FALSE(CensoredTimes{}.Percentile(0.5));
}

SpoofRun RunWith(std::optional<double> met_after_s, double exposure_m) {
  SpoofRun run;
  SourceOutcome source;
  source.false_in_view_s = 5.0;
  source.met_after_s = met_after_s;
  source.was_detected = met_after_s.has_value();
  run.attackers = {source};
  source.false_in_view_s = 0.5;  // Too short a time to count.
  run.attackers.push_back(source);
  run.exposure.max_m = exposure_m;
  run.exposure.harm_s = exposure_m > 3.0 ? 1.0 : 0.0;
  run.exposure.curve_m = {0.0, exposure_m};
  run.by_message = {50, 0, 50, 100};
  run.honest.vehicle_s = 3600.0;
  return run;
}

TEST(PoolAttack, CountsSourcesThatWereInViewAndTakesTheWorstExposure) {
  const SpoofRun a = RunWith(1.0, 1.5), b = RunWith(std::nullopt, 5.0), c = RunWith(2.0, 0.0);
  const SpoofRun* runs[] = {&a, &b, &c};
  const AttackFigures figures = PoolAttack(runs);
  EXPECT_EQ(figures.runs, 3);
  EXPECT_EQ(figures.sources, 3);
  EXPECT_NEAR(*figures.withdraw_rate(), 2.0 / 3.0, 1e-12);
  EXPECT_EQ(*figures.accuse_rate(), 0.0);
  EXPECT_EQ(figures.met_after.Percentile(0.5), 2.0);
  EXPECT_FALSE(figures.met_after.Percentile(0.95));
  EXPECT_EQ(figures.exposure_max_m, 5.0);
  EXPECT_EQ(figures.exposure_p95_m, 5.0);
  EXPECT_NEAR(figures.harm_s, 1.0 / 3.0, 1e-12);
  EXPECT_EQ(figures.curve_m, (std::vector<double>{0.0, 5.0}));
  EXPECT_NEAR(*figures.by_message.f1, 2.0 / 3.0, 1e-12);
  EXPECT_FALSE(figures.checks_by_message);
  EXPECT_NEAR(figures.honest.vehicle_s, 3.0 * 3600.0, 1e-9);
  EXPECT_NEAR(*figures.score(), 0.4 * 2.0 / 3.0 + 0.3 * std::exp(-0.4) + 0.3 * std::exp(-1.0),
              1e-12);
}

TEST(PoolAttack, WithoutSourcesThereIsNoRateAndNoScore) {
  const SpoofRun honest;
  const SpoofRun* runs[] = {&honest};
  const AttackFigures figures = PoolAttack(runs);
  EXPECT_FALSE(figures.withdraw_rate());
  EXPECT_FALSE(figures.score());
}

TEST(CompositeScore, IsTheWeakestTimesWhatTheHonestSuffer) {
  HonestTreatment honest;
  honest.vehicle_s = 10.0 * 3600.0;
  honest.accusations = 2;
  honest.in_view = 100;
  honest.validated = 95;
  EXPECT_NEAR(*CompositeScore(0.9, honest), 100.0 * 0.9 * 0.8 * 0.95, 1e-9);
  honest.accusations = 20;
  EXPECT_EQ(*CompositeScore(0.9, honest), 0.0);
  EXPECT_FALSE(CompositeScore(std::nullopt, honest));
  EXPECT_FALSE(CompositeScore(0.9, HonestTreatment{}));
}

}  // namespace
}  // namespace v2vouch::evaluation
