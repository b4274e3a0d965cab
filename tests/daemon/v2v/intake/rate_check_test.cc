// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/rate_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace v2vouch {
namespace {

const MessageCheckConfig kConfig;

Timestamp At(double seconds) { return FromMicros(1'700'000'000'000'000) + FromSeconds(seconds); }

// Messages at `times_s`, each refused when a budget of 12 a second with bursts of 10 is spent.
// @return the gravest verdict of all, 0 = none.
int Worst(const std::vector<double>& times_s) {
  RateCheck check;
  double tokens = 10.0;
  double last_s = times_s.front();
  int worst = 0;
  for (const double time_s : times_s) {
    check.OnMessage(At(time_s));
    tokens = std::min(10.0, tokens + 12.0 * (time_s - last_s));
    last_s = time_s;
    if (tokens < 1.0) {
      check.OnRefused(At(time_s));
      continue;
    }
    tokens -= 1.0;
    if (const auto finding = check.Judge(At(time_s), kConfig)) {
      EXPECT_EQ(finding->check, Check::kMessageRate);
      EXPECT_GT(finding->value, finding->limit * 0.999);
      worst = std::max(worst, static_cast<int>(finding->severity));
    }
  }
  return worst;
}

std::vector<double> Steady(double rate_hz, double duration_s) {
  std::vector<double> times_s;
  for (int i = 0; i < static_cast<int>(rate_hz * duration_s); ++i) times_s.push_back(i / rate_hz);
  return times_s;
}

TEST(RateCheck, HonestRatesAreClean) {
  EXPECT_EQ(Worst(Steady(10.0, 60.0)), 0);
  EXPECT_EQ(Worst(Steady(1.0, 60.0)), 0);
}

TEST(RateCheck, PairsFiftyMillisecondsApartAreClean) {
  std::vector<double> times_s;
  for (int i = 0; i < 600; ++i) {
    times_s.push_back(0.1 * i);
    if (i % 9 == 0) times_s.push_back(0.1 * i + 0.05);  // 11 %, as in real logs.
  }
  EXPECT_EQ(Worst(times_s), 0);
}

TEST(RateCheck, ASecondsMessagesAtOnceAreNoRate) {
  std::vector<double> times_s = Steady(10.0, 20.0);
  for (int i = 0; i < 100; ++i) times_s.push_back(23.0 + 1e-4 * i);  // The receiver hung.
  for (int i = 0; i < 100; ++i) times_s.push_back(23.1 + 0.1 * i);
  EXPECT_EQ(Worst(times_s), 0);
}

TEST(RateCheck, FourTimesTheRateIsWithdrawnNotAccused) {
  EXPECT_EQ(Worst(Steady(40.0, 2.0)), 0);  // Not before two seconds over the budget.
  EXPECT_EQ(Worst(Steady(40.0, 10.0)), 1);
}

TEST(RateCheck, FortyTimesTheRateIsAccusedWithinTwoSeconds) {
  EXPECT_EQ(Worst(Steady(400.0, 0.9)), 0);
  EXPECT_EQ(Worst(Steady(400.0, 2.0)), 2);
  EXPECT_EQ(Worst(Steady(10000.0, 2.0)), 2);
}

TEST(RateCheck, ItIsOverWhenItIsOver) {
  RateCheck check;
  for (const double time_s : Steady(400.0, 3.0)) {
    check.OnMessage(At(time_s));
    check.OnRefused(At(time_s));
  }
  EXPECT_TRUE(check.Judge(At(3.0), kConfig));
  EXPECT_FALSE(check.Judge(At(4.6), kConfig));
}

}  // namespace
}  // namespace v2vouch
