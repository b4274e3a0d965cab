// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/ieee1609/dot2_time.h"

namespace v2vouch::obu {
namespace {

constexpr std::int64_t kEpoch_s = 1072915200;  // 2004-01-01 00:00:00 UTC.
constexpr std::int64_t kMicros = 1000000;

// First second UTC after each leap second since 2004 (IERS Bulletin C).
constexpr std::int64_t kLeapSeconds_s[] = {
    1136073600,  // 2006-01-01
    1230768000,  // 2009-01-01
    1341100800,  // 2012-07-01
    1435708800,  // 2015-07-01
    1483228800,  // 2017-01-01
};

}  // namespace

std::int64_t UtcOfDot2Micros(std::uint64_t since_2004_us) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 60;
  if (since_2004_us > kMost) return 0;
  std::int64_t utime = kEpoch_s * kMicros + static_cast<std::int64_t>(since_2004_us);
  for (const std::int64_t leap_s : kLeapSeconds_s) {
    if (utime >= (leap_s + 1) * kMicros) utime -= kMicros;
  }
  return utime;
}

std::uint64_t Dot2MicrosOfUtc(std::int64_t utime) {
  if (utime < kEpoch_s * kMicros) return 0;
  std::int64_t count = utime - kEpoch_s * kMicros;
  for (const std::int64_t leap_s : kLeapSeconds_s) {
    if (utime >= leap_s * kMicros) count += kMicros;
  }
  return static_cast<std::uint64_t>(count);
}

}  // namespace v2vouch::obu
