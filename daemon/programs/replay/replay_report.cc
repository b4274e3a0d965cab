// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "daemon/programs/replay/replay.h"

namespace v2vouch {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Quantiles {
  double p50 = kNone;
  double p99 = kNone;
  double max = kNone;
};

// Nearest-rank quantiles.
Quantiles QuantilesOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto rank = [&](double share) {
    const auto n = static_cast<double>(values.size());
    return values[static_cast<std::size_t>(std::ceil(share * n)) - 1];
  };
  return {rank(0.50), rank(0.99), values.back()};
}

// "none" for a statistic of nothing.
std::string Line(const char* format, double value) {
  char text[160];
  if (std::isnan(value)) return std::string(format, std::strcspn(format, "%")) + "none\n";
  std::snprintf(text, sizeof(text), format, value);
  return std::string(text) + "\n";
}

std::string CountLine(const std::string& what, std::int64_t count) {
  return what + std::string(what.size() < 22 ? 22 - what.size() : 1, ' ') + std::to_string(count) +
         "\n";
}

}  // namespace

std::string JsonReport(const ReplayResult& result) {
  const Quantiles step = QuantilesOf(result.step_us);
  nlohmann::ordered_json refused = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < kReasonCount; ++i) {
    if (result.refused[i] > 0) {
      refused[std::string(ReasonName(static_cast<Reason>(i)))] = result.refused[i];
    }
  }
  nlohmann::ordered_json notices = nlohmann::ordered_json::array();
  for (const ReplayedNotice& each : result.notices) {
    notices.push_back({{"name", each.notice.name},
                       {"channel", each.notice.channel},
                       {"value", each.notice.value},
                       {"since_utime", ToMicros(each.notice.since)},
                       {"times", each.times}});
  }
  nlohmann::ordered_json channels = nlohmann::ordered_json::object();
  for (const auto& [name, figures] : result.channels) {
    nlohmann::ordered_json of_channel = {{"input", figures.is_input},
                                         {"received", figures.received}};
    if (figures.is_input) of_channel["accepted"] = figures.accepted;
    for (const auto& [reason, count] : figures.refused) {
      of_channel["refused"][std::string(ReasonName(reason))] = count;
    }
    channels[name] = std::move(of_channel);
  }
  nlohmann::ordered_json details = nlohmann::ordered_json::array();
  for (const RefusalTable::Row& row : result.refusal_details) {
    details.push_back({{"channel", row.channel},
                       {"reason", ReasonName(row.refusal.reason)},
                       {"field", row.FieldText()},
                       {"count", row.count}});
  }
  const nlohmann::ordered_json report = {
      {"events", result.events},
      {"inputs", result.inputs},
      {"accepted", result.accepted},
      {"copied", result.copied},
      {"old_outputs", result.old_outputs},
      {"unseen_pictures", result.unseen_pictures},
      {"damaged", result.damaged},
      {"lists", result.lists},
      {"log_seconds", result.log_seconds},
      {"wall_seconds", result.wall_seconds},
      {"realtime_factor", result.realtime_factor()},
      {"step_us", {{"p50", step.p50}, {"p99", step.p99}, {"max", step.max}}},
      {"refused", refused},
      {"notices", notices},
      {"channels", channels},
      {"problems", result.verdict.problems},
      {"notes", result.verdict.notes},
      {"refusal_details", details},
      {"digest_local", result.digest_local},
      {"digest_priority", result.digest_priority}};
  return report.dump() + "\n";
}

std::string TextReport(const ReplayResult& result) {
  const Quantiles step = QuantilesOf(result.step_us);
  std::string text;
  text += CountLine("events", result.events);
  text += CountLine("inputs", result.inputs);
  text += CountLine("accepted", result.accepted);
  text += CountLine("passed through", result.copied);
  if (result.old_outputs > 0) text += CountLine("old outputs dropped", result.old_outputs);
  if (result.unseen_pictures > 0) {
    text += CountLine("pictures unseen", result.unseen_pictures);
    text += "                      (v2vouch-detect --log adds what the network sees)\n";
  }
  if (result.damaged > 0) text += CountLine("damaged stretches", result.damaged);
  text += CountLine("lists", result.lists);
  text += Line("log                   %.2f s", result.log_seconds);
  text += Line("wall                  %.3f s", result.wall_seconds);
  text += Line("real time             x %.0f", result.realtime_factor());
  text += Line("step p50              %.1f us", step.p50);
  text += Line("step p99              %.1f us", step.p99);
  text += Line("step max              %.1f us", step.max);
  for (std::size_t i = 0; i < kReasonCount; ++i) {
    if (result.refused[i] == 0) continue;
    text += CountLine("refused " + std::string(ReasonName(static_cast<Reason>(i))),
                      static_cast<std::int64_t>(result.refused[i]));
    for (const RefusalTable::Row& row : result.refusal_details) {
      if (row.refusal.reason != static_cast<Reason>(i)) continue;
      const std::string field = row.refusal.field.empty() ? "message" : row.FieldText();
      text += CountLine("  " + (row.channel.empty() ? "(others)" : row.channel) + " " + field,
                        static_cast<std::int64_t>(row.count));
    }
  }
  for (const ReplayedNotice& each : result.notices) {
    char value[32];
    std::snprintf(value, sizeof(value), " %.3g", each.notice.value);
    text += "notice " + each.notice.name + " " + each.notice.channel + value + ": " +
            each.notice.advice + "\n";
  }
  text += "digest LOCAL          " + result.digest_local + "\n";
  text += "digest PRIORITY       " + result.digest_priority + "\n";
  return text;
}

}  // namespace v2vouch
