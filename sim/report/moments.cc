// SPDX-License-Identifier: Apache-2.0
#include "sim/report/moments.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::evaluation {
namespace {

constexpr double kLongestWorth_s = 10.0;  // Longer hiding is beyond any bridging budget.

enum class Sight { kAbsent, kSeen, kHidden, kOutOfView };

Sight SightOf(const Evaluation& evaluation, std::size_t object, Timestamp t) {
  const TruthObject& truth = evaluation.log.truth.objects[object];
  const auto motion = truth.motion.At(t);
  const auto ego = evaluation.log.truth.ego.At(t);
  if (!motion || !ego) return Sight::kAbsent;
  if ((motion->position() - ego->position()).norm() > evaluation.settings.radius_m) {
    return Sight::kAbsent;
  }
  const Pose<World, Body> X_WB(ego->x_m, ego->y_m, ego->yaw_rad);
  switch (TrueSighting(*truth.motion.InForce(t), *motion, X_WB, evaluation.log.specs)) {
    case Sighting::kVisible:
      return Sight::kSeen;
    case Sighting::kHidden:
      return Sight::kHidden;
    case Sighting::kOutOfView:
      break;
  }
  return Sight::kOutOfView;
}

double SecondsAt(const Evaluation& evaluation, std::size_t instant) {
  return ToSeconds(evaluation.grid[instant] - evaluation.grid.front());
}

Moment MomentAt(const Evaluation& evaluation, double t_s, std::string title) {
  const double last = static_cast<double>(evaluation.grid.size() - 1);
  const double k = std::clamp(std::round(t_s / evaluation.settings.period_s), 0.0, last);
  const auto instant = static_cast<std::size_t>(k);
  return {instant, SecondsAt(evaluation, instant), std::move(title)};
}

}  // namespace

std::vector<Interval> UnseenIntervals(const Evaluation& evaluation, std::size_t object,
                                      bool after_sight, std::optional<Sighting> only) {
  std::vector<Interval> intervals;
  bool was_meant = false;
  bool was_seen = !after_sight;
  for (std::size_t k = 0; k < evaluation.grid.size(); ++k) {
    const Sight sight = SightOf(evaluation, object, evaluation.grid[k]);
    was_seen = was_seen || sight == Sight::kSeen;
    const bool is_meant = was_seen && ((sight == Sight::kHidden && only != Sighting::kOutOfView) ||
                                       (sight == Sight::kOutOfView && only != Sighting::kHidden));
    const double t_s = SecondsAt(evaluation, k);
    if (is_meant && !was_meant) intervals.push_back({t_s, t_s});
    if (is_meant) intervals.back().to_s = t_s + evaluation.settings.period_s;
    was_meant = is_meant;
  }
  return intervals;
}

std::optional<std::size_t> CriticalVehicle(const Evaluation& evaluation) {
  std::optional<std::size_t> best;
  double best_worth = 0.5;  // Less is a flicker.
  const auto& objects = evaluation.log.truth.objects;
  for (std::size_t o = 0; o < objects.size(); ++o) {
    if (!objects[o].is_vehicle() || !objects[o].has_v2v) continue;
    double worth = 0.0;
    for (const Interval& unseen : UnseenIntervals(evaluation, o, true)) {
      const auto after = MomentAt(evaluation, unseen.to_s + 0.3, "").instant;
      const bool is_back = SightOf(evaluation, o, evaluation.grid[after]) == Sight::kSeen;
      worth += std::min(unseen.to_s - unseen.from_s, kLongestWorth_s) * (is_back ? 2.0 : 1.0);
    }
    if (worth > best_worth) {
      best_worth = worth;
      best = o;
    }
  }
  return best;
}

std::vector<Moment> ChooseMoments(const Evaluation& evaluation,
                                  std::optional<std::size_t> critical) {
  const double end_s = SecondsAt(evaluation, evaluation.grid.size() - 1);
  if (!critical) {
    return {MomentAt(evaluation, 0.25 * end_s, "a quarter through"),
            MomentAt(evaluation, 0.5 * end_s, "half-way"),
            MomentAt(evaluation, 0.75 * end_s, "three quarters through")};
  }
  const std::string name =
      "vehicle " + std::to_string(evaluation.log.truth.objects[*critical].id) + " ";
  Interval longest;
  for (const Interval& unseen : UnseenIntervals(evaluation, *critical, true)) {
    if (unseen.to_s - unseen.from_s > longest.to_s - longest.from_s) longest = unseen;
  }
  const Moment after = MomentAt(evaluation, longest.to_s + 0.7, "");
  const bool is_back =
      SightOf(evaluation, *critical, evaluation.grid[after.instant]) == Sight::kSeen;
  const double length_s = std::min(longest.to_s - longest.from_s, 8.0);
  Moment unseen = MomentAt(evaluation, longest.from_s + 0.7 * length_s, "");
  const Sight how = SightOf(evaluation, *critical, evaluation.grid[unseen.instant]);
  unseen.title =
      name + SightingName(how == Sight::kOutOfView ? Sighting::kOutOfView : Sighting::kHidden);
  return {MomentAt(evaluation, longest.from_s - 0.5, name + "seen"), unseen,
          is_back ? MomentAt(evaluation, longest.to_s + 0.7, name + "back")
                  : MomentAt(evaluation, longest.from_s + length_s + 1.0, name + "later")};
}

}  // namespace v2vouch::evaluation
