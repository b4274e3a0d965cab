// SPDX-License-Identifier: Apache-2.0
#include "sim/run_log/why_not_judged.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace v2vouch::evaluation {
namespace {

// "2023-11-14 22:13:20.000 UTC (1700000000000000 us)".
std::string TimeText(Timestamp stamp) {
  const std::int64_t us = ToMicros(stamp);
  const std::chrono::sys_seconds seconds{
      std::chrono::floor<std::chrono::seconds>(std::chrono::microseconds(us))};
  const auto day = std::chrono::floor<std::chrono::days>(seconds);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss time(seconds - day);
  char text[120];
  std::snprintf(text, sizeof text, "%04d-%02u-%02u %02d:%02d:%02d UTC (utime %lld)",
                static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), static_cast<int>(time.hours().count()),
                static_cast<int>(time.minutes().count()), static_cast<int>(time.seconds().count()),
                static_cast<long long>(us));
  return text;
}

std::string SpanText(double seconds) {
  char text[64];
  const double size = std::abs(seconds);
  if (size < 120.0) {
    std::snprintf(text, sizeof text, "%.1f s", size);
  } else if (size < 86400.0) {
    std::snprintf(text, sizeof text, "%.1f hours", size / 3600.0);
  } else {
    std::snprintf(text, sizeof text, "%.1f days", size / 86400.0);
  }
  return text;
}

}  // namespace

std::string OtherTypesText(const std::map<std::string, std::int64_t>& other_types) {
  std::string channels;
  for (const auto& [channel, count] : other_types) {
    channels += (channels.empty() ? "" : ", ") + channel + " (" + std::to_string(count) + ")";
  }
  return "Messages of another version of their type (the fingerprint differs): " + channels +
         ". track_t changed in 2026-11 (CHANGELOG.md): make the lists anew with `v2vouch-replay "
         "LOG "
         "--out OUT`, or read them with the build that wrote them";
}

std::string WhyNotJudged(const RunLog& log) {
  if (log.truth.empty()) {
    return "holds no TRUTH, so nothing can be judged. `--summary` counts its lists";
  }
  if (log.truth_step) {
    const double step_s = 1e-6 * (static_cast<double>(ToMicros(log.truth_step->to)) -
                                  static_cast<double>(ToMicros(log.truth_step->from)));
    return "the time of TRUTH steps " + std::string(step_s < 0.0 ? "back" : "on") + " by " +
           SpanText(step_s) + ", from " + TimeText(log.truth_step->from) + " to " +
           TimeText(log.truth_step->to) +
           ": not one drive; cut the log there, or mend the stamps that are wrong";
  }
  const auto& local = log.lists[Index(ListKind::kLocal)];
  const auto& priority = log.lists[Index(ListKind::kPriority)];
  if (local.empty() && priority.empty() && !log.other_types.empty()) {
    return "holds no list that this build can read. " + OtherTypesText(log.other_types);
  }
  if (local.empty() && priority.empty()) {
    return "holds no TRACKS_LOCAL and no TRACKS_PRIORITY, so there is nothing to judge; "
           "`v2vouch-replay LOG --out OUT` makes them";
  }
  const Timestamp begin = log.truth.begin(), end = log.truth.end();
  if (end - begin < std::chrono::seconds(1)) {
    return "its TRUTH lasts " + SpanText(ToSeconds(end - begin)) +
           ", and the first second is not judged (are its stamps microseconds?)";
  }
  constexpr std::int64_t kMostCells = 200'000'000;  // About 10 GB of bound.
  const auto instants = static_cast<std::int64_t>(ToSeconds(end - begin) * 20.0) + 1;
  if (instants * static_cast<std::int64_t>(log.truth.objects.size()) > kMostCells) {
    return "its TRUTH is too long to be judged at once (" + SpanText(ToSeconds(end - begin)) +
           ", " + std::to_string(log.truth.objects.size()) + " objects): cut the log";
  }
  Timestamp first = Timestamp::max(), last = Timestamp::min();
  for (const auto* lists : {&local, &priority}) {
    for (const ReceivedList& list : *lists) {
      if (list.stamp >= begin && list.stamp <= end && list.received <= end) return "";
      first = std::min(first, list.stamp);
      last = std::max(last, list.stamp);
    }
  }
  return "its lists and its TRUTH do not overlap in time: lists from " + TimeText(first) + " to " +
         TimeText(last) + ", TRUTH from " + TimeText(begin) + " to " + TimeText(end) +
         "; do both come from the same drive and clock?";
}

}  // namespace v2vouch::evaluation
