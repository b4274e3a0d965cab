// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "daemon/programs/warn/warn_log.h"

namespace v2vouch {
namespace {

double Share(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

// "1.5 s"; "none" for what is not known or not there.
std::string Amount(double value, const char* unit) {
  if (!std::isfinite(value)) return "none";
  char text[48];
  std::snprintf(text, sizeof(text), "%.1f %s", value, unit);
  return text;
}

constexpr std::pair<std::int32_t, const char*> kDegraded[] = {
    {warnings::kNoPriority, "no PRIORITY: hidden vehicles are not known"},
    {warnings::kGnssSuspect, "ego GNSS suspect: the V2V side is frozen"},
    {warnings::kSectorsMissing, "a sector that a kind needs is not watched"},
    {warnings::kListsStale, "stale lists"},
    {warnings::kNoEgo, "no EGO_MOTION"},
    {warnings::kNoIntent, "no EGO_INTENT: LTA waits for the turn itself"}};

}  // namespace

std::string WarningLine(const warnings::Warning& warning) {
  char text[320];
  const warnings::Figures& f = warning.figures;
  std::snprintf(
      text, sizeof(text),
      "%-4s %-6s track %lld local %lld at %.1f %.1f m %.1f m/s: P %.2f in %s (early "
      "%s), gap %s, brake %s, last seen %s, budget %s",
      warnings::KindName(warning.kind), warnings::LevelName(warning.level),
      static_cast<long long>(warning.track_id), static_cast<long long>(warning.local_id),
      f.position_B.x(), f.position_B.y(), f.speed_mps, f.conflict_probability,
      Amount(f.time_to_conflict_s, "s").c_str(), Amount(f.time_to_conflict_early_s, "s").c_str(),
      Amount(f.post_encroachment_s, "s").c_str(), Amount(f.required_decel_mps2, "m/s2").c_str(),
      Amount(f.own_sensor_age_s, "s ago").c_str(), Amount(f.bridge_budget_s, "s").c_str());
  return text;
}

std::string WarnJson(const WarnResult& result) {
  const auto number = [](double v) {
    return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json(nullptr);
  };
  nlohmann::ordered_json episodes = nlohmann::ordered_json::array();
  for (const WarnEpisode& each : result.episodes) {
    const warnings::Figures& f = each.worst.figures;
    episodes.push_back({{"kind", warnings::KindName(each.worst.kind)},
                        {"level", warnings::LevelName(each.worst.level)},
                        {"track_id", each.worst.track_id},
                        {"local_id", each.worst.local_id},
                        {"since_utime", ToMicros(each.worst.since)},
                        {"until_utime", ToMicros(each.until)},
                        {"conflict_probability", number(f.conflict_probability)},
                        {"time_to_conflict_s", number(f.time_to_conflict_s)},
                        {"post_encroachment_s", number(f.post_encroachment_s)},
                        {"required_decel_mps2", number(f.required_decel_mps2)},
                        {"own_sensor_age_s", number(f.own_sensor_age_s)},
                        {"bridge_budget_s", number(f.bridge_budget_s)}});
  }
  return nlohmann::ordered_json{{"events", result.events},
                                {"taken", result.taken},
                                {"refused", result.refused},
                                {"lists", result.lists},
                                {"log_seconds", result.log_seconds},
                                {"always_degraded", result.degraded},
                                {"step_us",
                                 {{"p50", Share(result.step_us, 0.5)},
                                  {"p99", Share(result.step_us, 0.99)},
                                  {"max", Share(result.step_us, 1.0)}}},
                                {"warnings", episodes}}
             .dump() +
         "\n";
}

std::string WarnText(const WarnResult& result) {
  char line[200];
  std::string text;
  std::snprintf(line, sizeof(line),
                "%lld warning lists in %.1f s of log, step p50 %.0f p99 %.0f us\n",
                static_cast<long long>(result.lists), result.log_seconds,
                Share(result.step_us, 0.5), Share(result.step_us, 0.99));
  text += line;
  for (const auto& [bit, what] : kDegraded) {
    if ((result.degraded & bit) != 0) text += std::string("throughout: ") + what + "\n";
  }
  for (const WarnEpisode& each : result.episodes) {
    std::snprintf(line, sizeof(line),
                  "at %6.2f s, %.2f s long: ", ToSeconds(each.worst.since - result.first),
                  ToSeconds(each.until - each.worst.since));
    text += line + WarningLine(each.worst) + "\n";
  }
  if (result.episodes.empty()) text += "no warning\n";
  return text;
}

}  // namespace v2vouch
