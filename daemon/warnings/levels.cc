// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/levels.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::warnings {

Levels LevelsOf(const Target& target, const Conflict& conflict, const Figures& figures,
                const LevelBounds& bounds, const WarningsConfig& config) {
  Levels levels;
  // NaN compares false: never measured by an own sensor, never URGENT.
  const bool may_be_urgent = figures.own_sensor_age_s <= config.urgent_unseen_s;
  const auto level_of = [&](double existence) {
    if (existence * conflict.probability_exact >= bounds.urgent_probability &&
        conflict.exact_median_s <= figures.urgent_before_s && may_be_urgent) {
      return Level::kUrgent;
    }
    if (existence * conflict.probability >= config.warn_probability &&
        conflict.median_s <= figures.warn_before_s) {
      return Level::kWarn;
    }
    return existence * conflict.probability >= config.advise_probability ? Level::kAdvise
                                                                         : Level::kInfo;
  };
  levels.level = level_of(target.existence);
  levels.if_sure = level_of(1.0);
  if (target.visibility != Visibility::kVisible && std::isfinite(conflict.reachable_s)) {
    const Level reach =
        conflict.reachable_s <= figures.warn_before_s ? Level::kWarn : Level::kAdvise;
    if (reach > levels.level) {
      levels.level = reach;
      levels.basis = Basis::kReachable;
    }
  }
  if (bounds.by_gap > levels.level && target.existence >= config.warn_probability) {
    levels.level = bounds.by_gap;
    levels.basis = Basis::kGap;
  }
  const Level at_most = target.is_sudden ? Level::kAdvise : bounds.at_most;
  levels.level = std::min(levels.level, at_most);
  levels.if_sure = std::max(levels.level, std::min(levels.if_sure, at_most));
  return levels;
}

}  // namespace v2vouch::warnings
