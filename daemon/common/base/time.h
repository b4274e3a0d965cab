// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace v2vouch {

/// Time base of every message: microseconds since 1970-01-01 00:00:00 UTC (LCM `utime`).
/// There is no now() on purpose. A Timestamp can only come out of a message, so code built on
/// it gives the same answer live, in replay and in a test.
struct MessageClock {
  using rep = std::int64_t;
  using period = std::micro;
  using duration = std::chrono::duration<rep, period>;
  using time_point = std::chrono::time_point<MessageClock>;
  static constexpr bool is_steady = false;  // GNSS time may step.
};
using Timestamp = MessageClock::time_point;
using Duration = MessageClock::duration;

constexpr Timestamp FromMicros(std::int64_t utime) { return Timestamp(Duration(utime)); }
constexpr std::int64_t ToMicros(Timestamp t) { return t.time_since_epoch().count(); }
constexpr double ToSeconds(Duration d) { return static_cast<double>(d.count()) * 1e-6; }

/// `seconds` rounded to the nearest microsecond.
inline Duration FromSeconds(double seconds) { return Duration(std::llround(seconds * 1e6)); }

}  // namespace v2vouch
