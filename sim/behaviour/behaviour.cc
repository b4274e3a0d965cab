// SPDX-License-Identifier: Apache-2.0
#include "sim/behaviour/behaviour.h"

#include <cmath>
#include <map>

#include "daemon/common/base/angle.h"

namespace v2vouch::evaluation {
namespace {

constexpr double kStanding_mps = 0.5;

std::size_t At(Sighting s) { return static_cast<std::size_t>(s); }

double Rms(double squares, std::int64_t count) {
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : kNoValue;
}

const ListedTrack* FindTrack(const ReceivedList& list, std::int64_t id) {
  for (const ListedTrack& track : list.tracks) {
    if (track.id == id) return &track;
  }
  return nullptr;
}

// Sums behind a LocalisationPart.
struct Part {
  double squares = 0.0, bounded_squares = 0.0, variance = 0.0;
  std::int64_t count = 0;

  [[nodiscard]] LocalisationPart Finish(double period_s) const {
    return {Rms(squares, count), variance > 0.0 ? std::sqrt(bounded_squares / variance) : kNoValue,
            static_cast<double>(count) * period_s};
  }
};

}  // namespace

std::int64_t VisibilityTable::said(Sighting s) const {
  return count[At(s)][0] + count[At(s)][1] + count[At(s)][2];
}
std::int64_t VisibilityTable::truly(Sighting s) const {
  return count[0][At(s)] + count[1][At(s)] + count[2][At(s)];
}
std::int64_t VisibilityTable::right(Sighting s) const { return count[At(s)][At(s)]; }
std::int64_t VisibilityTable::total() const {
  return said(Sighting::kVisible) + said(Sighting::kHidden) + said(Sighting::kOutOfView);
}
double VisibilityTable::share_right() const {
  return Share(right(Sighting::kVisible) + right(Sighting::kHidden) + right(Sighting::kOutOfView),
               total());
}
double VisibilityTable::share_right_of_said(Sighting s) const { return Share(right(s), said(s)); }
double VisibilityTable::share_found_of_true(Sighting s) const { return Share(right(s), truly(s)); }

ListBehaviour JudgeList(const RunLog& log, const std::vector<Timestamp>& grid, const Bound& bound,
                        const ListScore& score, const ScoringSettings& settings) {
  ListBehaviour result;
  Part moving, standing;
  double yaw_moving = 0.0, yaw_standing = 0.0;
  std::int64_t count_moving = 0, count_standing = 0;
  std::map<std::pair<std::size_t, std::int64_t>, bool> was_reversed;
  for (const MatchedPair& pair : score.pairs) {
    const TruthObject& object = log.truth.objects[pair.object];
    const ReceivedList* list = NewestBy(log.lists[Index(score.kind)], grid[pair.instant]);
    const ListedTrack* track = list == nullptr ? nullptr : FindTrack(*list, pair.track);
    if (track == nullptr) continue;
    const auto X_WB = log.truth.EgoPose(list->stamp);
    const auto truth = object.motion.At(list->stamp);
    const TruthSample* sample = object.motion.InForce(list->stamp);
    if (!X_WB || !truth || sample == nullptr) continue;
    const bool is_standing = std::abs(truth->speed_mps) < kStanding_mps;

    if (track->visibility >= 0 && track->visibility <= 2) {
      const Sighting is = TrueSighting(*sample, *truth, *X_WB, log.specs);
      ++result.visibility.count[static_cast<std::size_t>(track->visibility)][At(is)];
    }
    if (pair.sighting == Sighting::kVisible) {
      Part& part = is_standing ? standing : moving;
      const double square = pair.error_m * pair.error_m;
      part.squares += square;
      ++part.count;
      const BoundCell& cell = bound.At(score.kind, pair.object, pair.instant);
      if (cell.is_held) {
        part.bounded_squares += square;
        part.variance += cell.variance_m2;
      }
    }
    if (ToSeconds(list->stamp - track->start) <= HeadingFigures::kLeastAge_s) continue;
    const double error = WrapAngle(track->motion_B.yaw_rad + X_WB->yaw_rad() - truth->yaw_rad);
    const bool is_reversed = std::abs(error) > 0.5 * kPi;
    ++result.heading.samples;
    result.heading.reversed += is_reversed ? 1 : 0;
    (is_standing ? yaw_standing : yaw_moving) += error * error;
    ++(is_standing ? count_standing : count_moving);
    const auto [last, is_new] = was_reversed.try_emplace({pair.object, pair.track}, is_reversed);
    if (is_new) {
      ++result.heading.tracks;
      result.heading.born_reversed += is_reversed ? 1 : 0;
    } else if (is_reversed && !last->second) {
      ++result.heading.flips;
    }
    last->second = is_reversed;
  }
  result.heading.rms_moving_rad = Rms(yaw_moving, count_moving);
  result.heading.rms_standing_rad = Rms(yaw_standing, count_standing);
  result.moving = moving.Finish(settings.period_s);
  result.standing = standing.Finish(settings.period_s);
  return result;
}

}  // namespace v2vouch::evaluation
