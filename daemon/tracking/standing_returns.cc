// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "daemon/tracking/tracker.h"

namespace v2vouch {
namespace {

constexpr std::size_t kLeastGlances = 3;
constexpr double kRangeSigmas = 3.0;
// One place must be this much likelier than any other, as the logarithm of a ratio.
constexpr double kMargin = 2.0;
// Vehicles show several reflections within this depth, posts one: ln of how much likelier.
constexpr double kDepth_m = 3.0;
constexpr double kSeveral = 2.0;
constexpr double kLone = -1.5;

}  // namespace

// What no track was given of this radar's scan, in place of what was kept of its last one.
void Tracker::KeepReturns(const RadarLook& look, int radar,
                          std::span<const RadarMeasurement> measurements) {
  std::erase_if(recent_, [radar](const RecentReturn& at) { return at.radar == radar; });
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    const bool is_moving = !measurements[j].is_static;
    if (!is_moving && owner_[j] >= 0) continue;
    if (!candidates_[j].p_O.allFinite() || candidates_[j].reach_m == 0.0) continue;
    const Fix fix = settings_.point_targets ? FixOf(look, measurements[j])
                                            : ReflectionFixOf(look, measurements[j]);
    recent_.push_back({fix, radar, measurements[j].returns, is_moving});
  }
}

// The place of the standing returns that a track's boxes agree on, if there is one such place.
std::optional<Fix> Tracker::FindStanding(const Glances& glances) const {
  if (glances.size() < kLeastGlances) return std::nullopt;
  const auto count = static_cast<double>(glances.size());
  const double most = count + kRangeSigmas * std::sqrt(2.0 * count);

  double best_score = 0.0;
  double second_score = 0.0;
  double best_m = -1.0;
  double second_m = -1.0;
  for (const RecentReturn& at : recent_) {
    const auto misfit = glances.Misfit(at.fix.p_O);
    if (!misfit || *misfit > most) continue;
    if (at.is_moving) return std::nullopt;
    const double range_m = glances.RangeTo(at.fix.p_O);
    int returns = 0;
    for (const RecentReturn& other : recent_) {
      const double behind_m = glances.RangeTo(other.fix.p_O) - range_m;
      if (behind_m < 0.0 || behind_m > kDepth_m || !glances.Misfit(other.fix.p_O)) continue;
      returns += other.returns;
    }
    const double score = (returns > 1 ? kSeveral : kLone) - 0.5 * *misfit;
    if (best_m < 0.0 || score > best_score) {
      // One place shows itself once for each of its returns.
      if (best_m >= 0.0 && std::abs(best_m - range_m) > kDepth_m) {
        second_m = best_m;
        second_score = best_score;
      }
      best_m = range_m;
      best_score = score;
    } else if (std::abs(best_m - range_m) > kDepth_m && (second_m < 0.0 || score > second_score)) {
      second_m = range_m;
      second_score = score;
    }
  }
  if (best_m < 0.0 || (second_m >= 0.0 && best_score - second_score < kMargin)) {
    return std::nullopt;
  }

  Fix fix;
  fix.covariance.setZero();
  double sum = 0.0;
  for (const RecentReturn& at : recent_) {
    const double behind_m = glances.RangeTo(at.fix.p_O) - best_m;
    if (behind_m < 0.0 || behind_m > kDepth_m || !glances.Misfit(at.fix.p_O)) continue;
    fix.p_O += at.returns * at.fix.p_O;
    fix.covariance += at.returns * at.fix.covariance;
    sum += at.returns;
  }
  fix.p_O /= sum;
  fix.covariance /= sum;
  return fix;
}

}  // namespace v2vouch
