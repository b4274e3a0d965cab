// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "sim/warnings/judge_warnings.h"

namespace v2vouch::evaluation {
namespace {

nlohmann::ordered_json Number(double v) {
  return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json Json(const Outcome& outcome, bool brakes, bool is_needed) {
  return {{"brakes", brakes},
          {"contact", outcome.has_contact},
          {"contact_speed_mps", outcome.contact_speed_mps},
          {"needless", brakes && !is_needed},
          {"speed_lost_mps", outcome.speed_lost_mps}};
}

}  // namespace

std::string WarnScoreJson(const WarnScore& score) {
  nlohmann::ordered_json consumers;
  const bool is_needed = score.unwarned.has_contact;
  for (const Consumer consumer : kConsumers) {
    const ConsumerScore& each = score.consumers[static_cast<std::size_t>(consumer)];
    nlohmann::ordered_json kinds = nlohmann::ordered_json::object();
    for (const auto& [kind, counts] : each.kinds) {
      kinds[warnings::KindName(kind)] = {{"true", counts.true_count},
                                         {"late", counts.late},
                                         {"false", counts.false_count},
                                         {"early", counts.early},
                                         {"missed", counts.missed},
                                         {"unavoidable", counts.unavoidable},
                                         {"urgent", counts.urgent},
                                         {"urgent_false", counts.urgent_false},
                                         {"urgent_false_unseen", counts.urgent_false_unseen},
                                         {"delays_s", counts.delays_s}};
    }
    consumers[ConsumerKey(consumer)] = {
        {"kinds", kinds},
        {"planner", Json(each.planner, each.planner_brakes, is_needed)},
        {"driver", Json(each.driver, each.driver_brakes, is_needed)},
        {"first_urgent_s", Number(each.first_urgent_s)},
        {"first_warn_s", Number(each.first_warn_s)},
        {"lta_hidden_s", each.lta_hidden_s},
        {"lta_hidden_held_s", each.lta_hidden_held_s}};
  }
  return nlohmann::ordered_json{{"scenario", score.scenario},
                                {"seconds", score.seconds},
                                {"contact_unwarned", is_needed},
                                {"truth_first_urgent_s", Number(score.truth_first_urgent_s)},
                                {"truth_first_warn_s", Number(score.truth_first_warn_s)},
                                {"consumers", consumers}}
             .dump() +
         "\n";
}

std::string WarnScoreTable(const WarnScore& score) {
  char line[200];
  std::snprintf(line, sizeof(line), "warnings of %s, %.1f s; if nobody brakes: %s\n\n",
                score.scenario.c_str(), score.seconds,
                score.unwarned.has_contact ? "contact" : "no contact");
  std::string text = line;
  text += "consumer kind  true late missed unavoidable early false | urgent false\n";
  for (const Consumer consumer : kConsumers) {
    const ConsumerScore& each = score.consumers[static_cast<std::size_t>(consumer)];
    for (const auto& [kind, c] : each.kinds) {
      std::snprintf(line, sizeof(line), "%-8s %-5s %4d %4d %6d %11d %5d %5d | %6d %5d\n",
                    ConsumerKey(consumer), warnings::KindName(kind), c.true_count, c.late, c.missed,
                    c.unavoidable, c.early, c.false_count, c.urgent, c.urgent_false);
      text += line;
    }
  }
  text += "\nconsumer planner brakes contact needless | driver brakes contact needless\n";
  const auto yes = [](bool is) { return is ? "yes" : "no"; };
  for (const Consumer consumer : kConsumers) {
    const ConsumerScore& each = score.consumers[static_cast<std::size_t>(consumer)];
    const bool is_needed = score.unwarned.has_contact;
    std::snprintf(line, sizeof(line), "%-8s %14s %7s %8s | %13s %7s %8s\n", ConsumerKey(consumer),
                  yes(each.planner_brakes), yes(each.planner.has_contact),
                  yes(each.planner_brakes && !is_needed), yes(each.driver_brakes),
                  yes(each.driver.has_contact), yes(each.driver_brakes && !is_needed));
    text += line;
  }
  return text;
}

}  // namespace v2vouch::evaluation
