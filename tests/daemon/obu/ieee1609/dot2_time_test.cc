// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/ieee1609/dot2_time.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace v2vouch::obu {
namespace {

// Failure mode 10. The unit's own log has this BSM 5 ms later, by its UTC clock.
TEST(Dot2Time, FiveLeapSecondsLieBetween2004AndToday) {
  EXPECT_EQ(UtcOfDot2Micros(621714712490000), 1694629907490000);
  EXPECT_EQ(UtcOfDot2Micros(0), 1072915200000000);
}

TEST(Dot2Time, BothWaysAgreeOnEitherSideOfEachLeapSecond) {
  for (const std::int64_t leap_s : {1136073600, 1230768000, 1341100800, 1435708800, 1483228800}) {
    for (const std::int64_t offset_us : {-2000000L, -1L, 0L, 1L, 999999L, 86400000000L}) {
      const std::int64_t utime = leap_s * 1000000 + offset_us;
      EXPECT_EQ(UtcOfDot2Micros(Dot2MicrosOfUtc(utime)), utime) << leap_s << " " << offset_us;
    }
  }
}

TEST(Dot2Time, TimesThatCannotBeAreZero) {
  EXPECT_EQ(UtcOfDot2Micros(UINT64_MAX), 0);
  EXPECT_EQ(Dot2MicrosOfUtc(0), 0u);
}

}  // namespace
}  // namespace v2vouch::obu
