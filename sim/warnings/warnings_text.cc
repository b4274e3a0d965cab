// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "sim/warnings/judge_warnings.h"

namespace v2vouch::evaluation {
std::string WarnScoreTable(const WarnScore& score) {
  char line[200];
  std::snprintf(line, sizeof(line), "warnings of %s, %.1f s; if nobody brakes: %s\n\n",
                score.scenario.c_str(), score.seconds,
                score.unwarned.has_contact ? "contact" : "no contact");
  std::string text = line;
  text += "consumer kind  true late missed unavoidable early false | urgent false by-lie\n";
  for (const Consumer consumer : kConsumers) {
    const ConsumerScore& each = score.consumers[static_cast<std::size_t>(consumer)];
    for (const auto& [kind, c] : each.kinds) {
      std::snprintf(line, sizeof(line), "%-8s %-5s %4d %4d %6d %11d %5d %5d | %6d %5d %6d\n",
                    ConsumerKey(consumer), warnings::KindName(kind), c.true_count, c.late, c.missed,
                    c.unavoidable, c.early, c.false_count, c.urgent, c.urgent_false,
                    c.urgent_by_lie);
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
