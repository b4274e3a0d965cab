// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/exposure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "sim/metrics/placing.h"
#include "sim/metrics/scoring.h"
#include "sim/spoofing/joint_view.h"

namespace v2vouch::evaluation {
namespace {

constexpr double kSame_m = 1.0;   // A track belongs to a vehicle no further away than this ...
constexpr double kOther_m = 3.0;  // ... where no other is within this.

struct Nearest {
  double distance_m = std::numeric_limits<double>::infinity();
  double second_m = std::numeric_limits<double>::infinity();
  std::size_t object = 0;
};

Nearest NearestBox(const std::vector<TrueBox>& boxes, const Eigen::Vector2d& p_W) {
  Nearest nearest;
  for (const TrueBox& box : boxes) {
    const double distance_m = box.box.DistanceTo(p_W);
    if (distance_m < nearest.distance_m) {
      nearest.second_m = nearest.distance_m;
      nearest.distance_m = distance_m;
      nearest.object = box.object;
    } else {
      nearest.second_m = std::min(nearest.second_m, distance_m);
    }
  }
  return nearest;
}

// Nothing real around at all: as far away as the lists reach.
double Finite(double distance_m) { return std::min(distance_m, 1000.0); }

class Meter {
 public:
  Meter(const RunLog& log, const Senders& senders) : log_(log), senders_(senders), view_(log) {
    for (const BsmTruth& m : log.bsm_truths) {
      if (m.is_attack && (!begin_ || m.stamp < *begin_)) begin_ = m.stamp;
    }
  }

  void TakeInstant(Timestamp t, double period_s) {
    const auto placed = PlaceTracks(log_, NewestBy(log_.lists[Index(ListKind::kPriority)], t),
                                    ListKind::kPriority, t);
    ++result_.instants;
    if (placed.empty()) {
      ghosts_.clear();
      lingering_.clear();
      return;
    }
    const std::vector<TrueBox> boxes = TrueBoxes(log_.truth, t);
    const auto ego = log_.truth.ego.At(t);
    if (placed.size() > boxes.size()) ++result_.outnumbered;
    std::map<std::size_t, int> claimed;
    std::map<std::int64_t, double> ghosts_now;
    std::map<std::int64_t, double> lingering_now;
    const double since_s = ToSeconds(t - log_.truth.begin());
    for (const PlacedTrack& track : placed) {
      const Eigen::Vector2d p_W = track.motion_W.position();
      if (!ego || (p_W - ego->position()).norm() > Exposure::kReach_m) continue;
      const Nearest nearest = NearestBox(boxes, p_W);
      const double exposure_m = Finite(nearest.distance_m);
      if (nearest.distance_m <= kSame_m && nearest.second_m > kOther_m) ++claimed[nearest.object];
      const Senders::Attack* attack = senders_.AttackUnder(track.track->sender, t);
      if (exposure_m > Exposure::kGhost_m) {
        const Ghost now{track.track->id, track.track->sender, attack != nullptr, since_s,
                        since_s,         exposure_m};
        TakeGhost(now, period_s, ghosts_now);
      }
      if (attack == nullptr) continue;
      TakeAttacker(*attack, t, p_W, boxes, exposure_m, period_s);
      if (exposure_m > Exposure::kLinger_m && view_.Sees(t, p_W, 0)) {
        const double so_far_s = lingering_[track.track->id] + period_s;
        lingering_now[track.track->id] = so_far_s;
        result_.lingered_s = std::max(result_.lingered_s, so_far_s);
      }
    }
    lingering_ = std::move(lingering_now);
    ghosts_ = std::move(ghosts_now);
    result_.doubled += std::any_of(claimed.begin(), claimed.end(),
                                   [](const auto& vehicle) { return vehicle.second > 1; })
                           ? 1
                           : 0;
  }

  Exposure Finish() { return std::move(result_); }

 private:
  void TakeGhost(const Ghost& now, double period_s, std::map<std::int64_t, double>& ghosts_now) {
    const auto before = ghosts_.find(now.track);
    const double lasted_s = before == ghosts_.end() ? 0.0 : before->second + period_s;
    ghosts_now[now.track] = lasted_s;
    // Half a period of tolerance: the grid is rounded to microseconds.
    if (lasted_s < Exposure::kGhost_s - 0.5 * period_s) return;
    const auto known = std::find_if(result_.ghosts.begin(), result_.ghosts.end(),
                                    [&](const Ghost& g) { return g.track == now.track; });
    if (known == result_.ghosts.end()) {
      result_.ghosts.push_back(now);
      result_.ghosts.back().from_s -= lasted_s;
    } else {
      known->to_s = now.to_s;
      known->is_of_attacker |= now.is_of_attacker;
      known->max_m = std::max(known->max_m, now.max_m);
    }
  }

  void TakeAttacker(const Senders::Attack& attack, Timestamp t, const Eigen::Vector2d& p_W,
                    const std::vector<TrueBox>& boxes, double exposure_m, double period_s) {
    result_.priority_s += period_s;
    result_.max_m = std::max(result_.max_m, exposure_m);
    if (exposure_m > Exposure::kHarm_m) result_.harm_s += period_s;
    const auto bin = static_cast<std::size_t>(ToSeconds(t - *begin_) / Exposure::kBin_s);
    if (result_.curve_m.size() <= bin) result_.curve_m.resize(bin + 1, 0.0);
    result_.curve_m[bin] = std::max(result_.curve_m[bin], exposure_m);
    for (const TrueBox& box : boxes) {
      if (log_.truth.objects[box.object].id != attack.original_vehicle) continue;
      const double distance_m = box.box.DistanceTo(p_W);
      result_.original_max_m = std::max(result_.original_max_m, distance_m);
      if (distance_m > Exposure::kHarm_m) result_.original_harm_s += period_s;
    }
  }

  const RunLog& log_;
  const Senders& senders_;
  std::optional<Timestamp> begin_;
  JointView view_;
  std::map<std::int64_t, double> lingering_;  // Seconds in clear view on end, by track.
  std::map<std::int64_t, double> ghosts_;     // Seconds above the limit on end, by track.
  Exposure result_;
};

}  // namespace

int Exposure::ghosts_of_attackers() const {
  return static_cast<int>(
      std::count_if(ghosts.begin(), ghosts.end(), [](const Ghost& g) { return g.is_of_attacker; }));
}

Exposure MeasureExposure(const RunLog& log, const Senders& senders) {
  ScoringSettings settings;
  settings.skip_s = 0.0;
  Meter meter(log, senders);
  for (const Timestamp t : MakeGrid(log.truth, settings)) meter.TakeInstant(t, settings.period_s);
  return meter.Finish();
}

}  // namespace v2vouch::evaluation
