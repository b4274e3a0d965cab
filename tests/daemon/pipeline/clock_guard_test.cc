// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/clock_guard.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

using Ruling = ClockGuard::Ruling;

constexpr Timestamp At(double seconds) {
  return FromMicros(1'700'000'000'000'000 + static_cast<std::int64_t>(seconds * 1e6));
}

ClockGuard Running() {
  ClockGuard guard{TimelineConfig{}};
  for (int i = 0; i < 10; ++i) {
    for (int source = 0; source < 3; ++source) {
      EXPECT_EQ(guard.Judge(source, At(0.05 * i)), Ruling::kAccept);
    }
  }
  return guard;
}

TEST(ClockGuard, OneSensorAheadIsRefusedUntilASecondAgrees) {
  ClockGuard guard = Running();
  EXPECT_EQ(guard.Judge(0, At(100.0)), Ruling::kTooFarAhead);
  EXPECT_EQ(guard.Judge(0, At(100.05)), Ruling::kTooFarAhead);
  EXPECT_EQ(guard.Judge(1, At(0.6)), Ruling::kAccept);
  EXPECT_EQ(*guard.newest(), At(0.6));
  EXPECT_EQ(guard.Judge(1, At(100.1)), Ruling::kAccept) << "two sources agree on the gap";
  EXPECT_EQ(guard.Judge(0, At(100.1)), Ruling::kAccept);
}

TEST(ClockGuard, TwoSensorsAheadThatDisagreeStayRefused) {
  ClockGuard guard = Running();
  EXPECT_EQ(guard.Judge(0, At(100.0)), Ruling::kTooFarAhead);
  EXPECT_EQ(guard.Judge(1, At(200.0)), Ruling::kTooFarAhead);
}

TEST(ClockGuard, ALogStartedAgainRestartsOnceAllHaveSteppedBack) {
  ClockGuard guard = Running();
  EXPECT_EQ(guard.Judge(0, At(-100.0)), Ruling::kAccept);
  EXPECT_EQ(guard.Judge(1, At(-100.0)), Ruling::kAccept);
  EXPECT_EQ(guard.Judge(2, At(-99.95)), Ruling::kRestart);
  EXPECT_EQ(*guard.newest(), At(-99.95));
}

TEST(ClockGuard, OneSensorSteppingBackRestartsNothing) {
  ClockGuard guard = Running();
  for (int i = 0; i < 100; ++i) {
    EXPECT_NE(guard.Judge(0, At(-100.0 + 0.05 * i)), Ruling::kRestart);
    EXPECT_EQ(guard.Judge(1, At(0.5 + 0.05 * i)), Ruling::kAccept);
  }
}

TEST(ClockGuard, ASourceThatIsGoneDoesNotBlockTheRestart) {
  ClockGuard guard = Running();
  bool has_restarted = false;
  for (int i = 0; i < 25 && !has_restarted; ++i) {
    has_restarted = guard.Judge(i % 2, At(-100.0 + 0.02 * i)) == Ruling::kRestart;
  }
  EXPECT_TRUE(has_restarted);
}

}  // namespace
}  // namespace v2vouch
