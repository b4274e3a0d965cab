// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/watchdog.h"

#include <gtest/gtest.h>

#include <array>

namespace v2vouch {
namespace {

using namespace std::chrono_literals;

// Ten seconds of a daemon's loop at 50 Hz. @return how often it was fed.
struct Loop {
  Watchdog::Clock::time_point start{};
  Watchdog watchdog{2s, start};

  int Seconds(bool receives, bool receives_bsm, bool publishes) {
    int fed = 0;
    for (int i = 0; i < 500; ++i, now += 20ms) {
      ticks[0] += receives ? 1 : 0;
      ticks[1] += receives_bsm ? 1 : 0;
      if (publishes) published = now;
      fed += watchdog.IsToBeFed(now, ticks, published) ? 1 : 0;
    }
    return fed;
  }
  Watchdog::Clock::time_point now = start;
  Watchdog::Clock::time_point published = start;
  std::array<std::int64_t, 2> ticks{};
};

TEST(Watchdog, IsFedWhileEveryPartGoesOn) {
  Loop loop;
  EXPECT_GE(loop.Seconds(true, true, true), 18);
}

TEST(Watchdog, IsNotFedOnceOneReceiveThreadStands) {
  for (const bool is_bsm : {false, true}) {
    Loop loop;
    loop.Seconds(true, true, true);
    EXPECT_LE(loop.Seconds(is_bsm, !is_bsm, true), 1);
    EXPECT_GE(loop.Seconds(true, true, true), 18);  // And goes on afterwards.
  }
}

TEST(Watchdog, IsNotFedOnceNothingIsPublished) {
  Loop loop;
  loop.Seconds(true, true, true);
  EXPECT_LE(loop.Seconds(true, true, false), 4);  // For 1.5 s more.
}

TEST(Watchdog, IsNeverFedWhereNobodyAsks) {
  Watchdog watchdog(std::nullopt, {});
  EXPECT_FALSE(watchdog.IsToBeFed(Watchdog::Clock::time_point(100s), {}, {}));
}

}  // namespace
}  // namespace v2vouch
