// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace v2vouch::obu {

/// Microseconds UTC of IEEE 1609.2's and ETSI's time, which counts every second since 2004-01-01
/// 00:00:00 UTC, leap seconds included. Without them the messages of today would lie 5 s ahead.
/// 0 where the result would not fit.
std::int64_t UtcOfDot2Micros(std::uint64_t since_2004_us);

/// The other way. 0 before 2004.
std::uint64_t Dot2MicrosOfUtc(std::int64_t utime);

/// Until then the table of leap seconds is known to be complete (IERS; 2026-06-28).
inline constexpr std::int64_t kLeapSecondsKnownUntil_utime = 1782604800000000;

}  // namespace v2vouch::obu
