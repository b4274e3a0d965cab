// SPDX-License-Identifier: Apache-2.0
#include "sim/warnings/warn_tally.h"

#include <algorithm>

namespace v2vouch::evaluation {

void ConsumerTally::Add(const ConsumerTally& other) {
  true_count += other.true_count;
  late += other.late;
  early += other.early;
  missed += other.missed;
  unavoidable += other.unavoidable;
  false_count += other.false_count;
  false_by_lie += other.false_by_lie;
  urgent += other.urgent;
  urgent_false += other.urgent_false;
  urgent_by_lie += other.urgent_by_lie;
  runs_by_lie += other.runs_by_lie;
  planner_contacts += other.planner_contacts;
  driver_contacts += other.driver_contacts;
  planner_needless += other.planner_needless;
  driver_needless += other.driver_needless;
  speed_lost_mps += other.speed_lost_mps;
  delays_s.insert(delays_s.end(), other.delays_s.begin(), other.delays_s.end());
}

std::optional<double> ConsumerTally::delay_p95_s() const {
  if (delays_s.empty()) return std::nullopt;
  std::vector<double> ordered = delays_s;
  std::ranges::sort(ordered);
  return ordered[static_cast<std::size_t>(0.95 * static_cast<double>(ordered.size() - 1))];
}

void WarnTally::Add(const WarnTally& other) {
  runs += other.runs;
  seconds += other.seconds;
  contacts_unwarned += other.contacts_unwarned;
  v2v.Add(other.v2v);
  local.Add(other.local);
  ours.Add(other.ours);
}

}  // namespace v2vouch::evaluation
