// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/merge_lists.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace v2vouch::warnings {
namespace {

void PredictInO(Target& target, double dt_s) {
  StateVector& x = target.state_O.mean;
  const double moved_m = x[kSpeed] * dt_s;
  const double yaw = x[kYaw] + 0.5 * dt_s * x[kYawRate];
  x[kX] += moved_m * std::cos(yaw);
  x[kY] += moved_m * std::sin(yaw);
  x[kYaw] += dt_s * x[kYawRate];
}

std::vector<Target> At(const TargetList* list, Timestamp now) {
  if (list == nullptr) return {};
  std::vector<Target> targets = list->targets;
  for (Target& target : targets) PredictInO(target, ToSeconds(now - list->stamp));
  return targets;
}

}  // namespace

std::vector<Target> MergeLists(const TargetList* local, const TargetList* priority, Timestamp now) {
  std::vector<Target> merged = At(local, now);
  for (Target& theirs : At(priority, now)) {
    const auto own = std::ranges::find_if(merged, [&theirs](const Target& each) {
      return theirs.local_id != 0 && each.local_id == theirs.local_id &&
             each.source != Source::kPriority;
    });
    if (own == merged.end()) {
      theirs.source = Source::kPriority;
      theirs.local_id = 0;
      merged.push_back(std::move(theirs));
      continue;
    }
    own->track_id = theirs.track_id;
    own->source = Source::kBoth;
    own->bridge_budget_s = theirs.bridge_budget_s;
    own->existence = std::max(own->existence, theirs.existence);
    own->last_own = std::max(own->last_own, theirs.last_own);
    own->says_hard_braking = theirs.says_hard_braking;
    if (own->visibility != Visibility::kVisible) {
      own->state_O = theirs.state_O;
      own->extent = theirs.extent;
    }
  }
  std::ranges::sort(merged, [](const Target& a, const Target& b) {
    return std::pair(a.local_id, a.track_id) < std::pair(b.local_id, b.track_id);
  });
  return merged;
}

}  // namespace v2vouch::warnings
