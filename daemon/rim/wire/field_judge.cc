// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/field_judge.h"

#include <algorithm>
#include <cstdlib>

namespace v2vouch::wire {
namespace {

constexpr std::int64_t kSecond_us = 1'000'000;
constexpr std::int64_t kYear2000_us = 946'684'800 * kSecond_us;
constexpr std::int64_t kYear2100_us = 4'102'444'800 * kSecond_us;
constexpr std::int64_t kYear2200_us = 7'258'118'400 * kSecond_us;
constexpr std::int64_t kWeek_us = 7 * 86'400 * kSecond_us;
constexpr std::int64_t kLargestSeq = std::int64_t{1} << 61;

bool IsThisCentury(std::int64_t utime) { return utime >= kYear2000_us && utime < kYear2100_us; }

}  // namespace

std::string_view TimeFault(std::int64_t utime, Timestamp received) {
  if (utime <= 0) return "utime";
  if (utime >= kYear2200_us) {
    return IsThisCentury(utime / 1000) ? "utime looks like nanoseconds" : "utime";
  }
  const std::int64_t now = ToMicros(received);
  if (now < kYear2000_us || utime >= kYear2000_us) return {};
  if (utime < kYear2100_us / 1000 && IsThisCentury(utime * 1000)) {
    return "utime looks like milliseconds";
  }
  const bool is_second = utime < kYear2100_us / kSecond_us && IsThisCentury(utime * kSecond_us) &&
                         std::abs(utime * kSecond_us - now) <= kWeek_us;
  return is_second ? "utime looks like seconds" : std::string_view{};
}

std::int64_t SafeSeq(std::int64_t seq) { return std::clamp(seq, -kLargestSeq, kLargestSeq); }

}  // namespace v2vouch::wire
