// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/utc_watch.h"

#include <gtest/gtest.h>

#include <random>

namespace v2vouch {
namespace {

Timestamp At(double seconds) { return FromMicros(1'700'000'000'000'000) + FromSeconds(seconds); }

/// Senders at 10 Hz whose messages take 0.07 to 0.34 s, heard by a car whose clock is off.
struct Street {
  UtcWatch watch;
  std::mt19937_64 rng{7};
  double from_s = 0.0;

  void Drive(int senders, double seconds, double clock_off_s, double share_lost = 0.0) {
    std::uniform_real_distribution<double> delay(0.07, 0.34);
    std::uniform_real_distribution<double> any(0.0, 1.0);
    for (double t = from_s; t < from_s + seconds; t += 0.1) {
      for (int i = 0; i < senders; ++i) {
        if (any(rng) < share_lost) continue;
        watch.OnMessage(static_cast<SenderId>(i + 1), At(t), delay(rng) + clock_off_s);
      }
    }
    from_s += seconds;
  }
};

TEST(UtcWatch, HonestDelaysAndLossesAreNoDifference) {
  for (const int senders : {1, 2, 5, 100}) {
    Street street;
    for (int second = 0; second < 300; ++second) {
      street.Drive(senders, 1.0, 0.0, 0.77);
      ASSERT_FALSE(street.watch.difference_s()) << senders << " senders, " << second << " s";
    }
  }
}

TEST(UtcWatch, AClockThatIsOffIsToldWithinTwelveSecondsAndEndsWhenItIsRight) {
  for (const int senders : {1, 2, 9}) {
    for (const double off_s : {-3600.0, -2.0, -0.5, -0.2, 0.3, 0.5, 1.0, 3.0, 25.0}) {
      Street street;
      street.Drive(senders, 12.0, off_s);
      ASSERT_TRUE(street.watch.difference_s()) << off_s;
      EXPECT_NEAR(*street.watch.difference_s(), off_s + 0.07, 0.06) << off_s;
      street.Drive(senders, 12.0, 0.0);
      EXPECT_FALSE(street.watch.difference_s()) << off_s;
    }
  }
}

// One sender that replays what it said two seconds ago, beside two honest ones.
TEST(UtcWatch, OneLaggingSenderBesideOthersSaysNothingOfTheClock) {
  Street street;
  for (int second = 0; second < 30; ++second) {
    for (int k = 0; k < 10; ++k) {
      street.watch.OnMessage(99, At(street.from_s + 0.1 * k), 2.1);
    }
    street.Drive(2, 1.0, 0.0);
    EXPECT_FALSE(street.watch.difference_s());
  }
}

TEST(UtcWatch, AFloodOfIdentitiesAndALongSilenceTellNothing) {
  UtcWatch watch;
  for (int i = 0; i < 60000; ++i) {
    watch.OnMessage(static_cast<SenderId>(i), At(0.001 * i), 5.0);
    ASSERT_FALSE(watch.difference_s());
  }
  Street street;
  street.Drive(1, 12.0, 1.0);
  ASSERT_TRUE(street.watch.difference_s());
  street.watch.OnMessage(1, At(100.0), 1.0);
  EXPECT_FALSE(street.watch.difference_s());
}

}  // namespace
}  // namespace v2vouch
