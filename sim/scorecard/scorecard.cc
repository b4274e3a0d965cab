// SPDX-License-Identifier: Apache-2.0
#include "sim/scorecard/scorecard.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "daemon/common/base/angle.h"
#include "sim/metrics/scoring.h"

namespace v2vouch::evaluation {
namespace {

constexpr double kUnseen_m = 3.0;
constexpr double kCoasting_s = 0.3, kLasting_s = 0.5;
constexpr double kInSight_s = 3.0;
constexpr int kCar = 1, kVan = 2, kTruck = 3, kBus = 4, kMotorcycle = 5;

double Nees(const ListedTrack& track, const Eigen::Vector2d& truth) {
  const Eigen::Matrix2d& P = track.position_covariance_B;
  if (!(P.allFinite() && P(0, 0) > 0.0 && P.determinant() > 0.0)) return kNoValue;
  const Eigen::Vector2d error = truth - track.motion_B.position();
  return error.dot(P.inverse() * error);
}

class Judge {
 public:
  Judge(const RunLog& log, ListKind kind, const ScorecardSettings& settings)
      : log_(log), settings_(settings) {
    card_.kind = kind;
    card_.settings = settings;
  }

  void Take(const Scene& scene) {
    if (scene.is_scored) {
      ++card_.instants;
      if (scene.list != nullptr) ++card_.lists;
      TakeFalse(scene);
    }
    for (const SceneTruth& truth : scene.truths) {
      if (!truth.is_in_scope) continue;
      const ListedTrack* track =
          truth.track < 0 ? nullptr : scene.tracks[static_cast<std::size_t>(truth.track)];
      NoteSight(scene, truth, track);
      if (!scene.is_scored) continue;
      TakeIdentity(truth, track);
      TakeSender(scene, truth, track);
      if (truth.range_m > settings_.near_m) continue;
      if (truth.is_visible()) TakeMissed(track == nullptr, card_.missed_visible);
      if (truth.is_plain()) TakeMissed(track == nullptr, card_.missed_plain);
      if (track != nullptr) TakePair(truth, *track);
    }
  }

  Scorecard Finish(const std::vector<Scene>& scenes) {
    for (const auto& [id, seen] : unseen_) {
      ++card_.unseen.ids;
      if (seen > kLasting_s + 1e-9) ++card_.unseen.lasting_ids;
    }
    card_.unseen.seconds = static_cast<double>(card_.unseen.entries) * settings_.period_s;
    card_.first_listing = JudgeFirstListing(log_, scenes, settings_);
    card_.lead = JudgeLead(scenes, settings_);
    return std::move(card_);
  }

 private:
  struct Sight {
    double last_visible_s = 0.0;
    double clear_since_s = 0.0;
    bool is_clear = false;
    double budget_s = 0.0;  ///< For bridging, when last visible; 0 = was not listed.
    bool is_visible = false;
  };

  void TakeFalse(const Scene& scene) {
    for (std::size_t j = 0; j < scene.tracks.size(); ++j) {
      const ListedTrack& track = *scene.tracks[j];
      const Eigen::Vector2d p = track.motion_B.position();
      if (p.norm() > settings_.radius_m) continue;
      double nearest = std::numeric_limits<double>::infinity();
      bool is_beside_road_user = false;
      for (const SceneTruth& truth : scene.truths) {
        nearest = std::min(nearest, truth.box_B.DistanceTo(p));
        // LOCAL may list what is really a pedestrian or cyclist without a class.
        is_beside_road_user =
            is_beside_road_user || (card_.kind == ListKind::kLocal && !truth.is_vehicle &&
                                    (truth.motion_B.position() - p).norm() < settings_.cutoff_m);
      }
      if (scene.owner[j] < 0 && !is_beside_road_user) ++card_.false_entries;
      if (nearest <= kUnseen_m) continue;
      ++card_.unseen.entries;
      double& coasted_s = unseen_.try_emplace(track.id, 0.0).first->second;
      if (ToSeconds(scene.stamp - track.last_hit) <= kCoasting_s) continue;
      ++card_.unseen.coasting;
      coasted_s += settings_.period_s;
    }
  }

  void NoteSight(const Scene& scene, const SceneTruth& truth, const ListedTrack* track) {
    if (truth.is_hidden) {
      if (const auto found = sight_.find(truth.object); found != sight_.end()) {
        found->second.is_visible = found->second.is_clear = false;
      }
      return;
    }
    const auto [found, is_new] = sight_.try_emplace(truth.object);
    Sight& sight = found->second;
    if (!sight.is_clear) sight.clear_since_s = scene.t_s;
    sight.is_clear = truth.is_clear();
    sight.is_visible = true;
    sight.last_visible_s = scene.t_s;
    sight.budget_s =
        track == nullptr || std::isnan(track->bridge_budget_s) ? 0.0 : track->bridge_budget_s;
  }

  static void TakeMissed(bool is_missed, Scorecard::Missed& missed) {
    ++missed.of;
    if (is_missed) ++missed.missed;
  }

  void TakeIdentity(const SceneTruth& truth, const ListedTrack* track) {
    if (track == nullptr || !truth.is_visible() || truth.range_m > settings_.radius_m) return;
    const auto [last, is_new] = last_track_.try_emplace(truth.object, track->id);
    if (is_new || last->second == track->id) return;
    ++card_.switches;
    last->second = track->id;
  }

  void TakeSender(const Scene& scene, const SceneTruth& truth, const ListedTrack* track) {
    if (!log_.truth.objects[truth.object].has_v2v || truth.range_m > settings_.radius_m) return;
    const auto found = sight_.find(truth.object);
    if (found == sight_.end()) return;
    const Sight& sight = found->second;
    if (sight.is_visible) {
      if (!sight.is_clear || truth.range_m > settings_.near_m ||
          scene.t_s - sight.clear_since_s < kInSight_s) {
        return;
      }
      ++card_.validated_of;
      if (track != nullptr) ++card_.validated;
      return;
    }
    const double hidden_s = scene.t_s - sight.last_visible_s;
    const auto take = [&](double from_s, double to_s, BridgeFigures& bridge) {
      if (hidden_s < from_s || hidden_s >= to_s) return;
      const bool is_covered = hidden_s <= sight.budget_s;
      ++bridge.samples;
      if (is_covered) ++bridge.covered;
      if (track == nullptr) return;
      ++bridge.kept;
      if (is_covered) ++bridge.covered_kept;
      bridge.error_m.Add((track->motion_B.position() - truth.motion_B.position()).norm());
    };
    take(1.0, 2.0, card_.hidden_1_2_s);
    take(3.0, 4.0, card_.hidden_3_4_s);
    take(1.0, 4.0, card_.hidden_1_4_s);
  }

  void TakePair(const SceneTruth& truth, const ListedTrack& track) {
    const double nees = Nees(track, truth.motion_B.position());
    if (!std::isnan(nees) && truth.is_hidden) card_.hidden.nees.Add(nees);
    if (!truth.is_visible()) return;
    if (!std::isnan(nees)) card_.visible.nees.Add(nees);
    const TruthObject& object = log_.truth.objects[truth.object];
    const double error = (track.motion_B.position() - truth.motion_B.position()).norm();
    ErrorParts& position = card_.position;
    position.all.Add(error);
    (!truth.is_clear()   ? position.partly_hidden
     : truth.is_moving() ? position.moving
                         : position.standing)
        .Add(error);
    if (object.object_class == kCar) position.cars.Add(error);
    if (object.object_class == kVan) position.vans.Add(error);
    if (object.object_class == kMotorcycle) position.motorcycles.Add(error);
    if ((object.object_class == kCar || object.object_class == kVan) && truth.is_plain()) {
      position.plain.Add(error);
    }
    if (object.object_class == kTruck || object.object_class == kBus) {
      position.lorries.Add(error);
      const Footprint listed{track.motion_B.position(), track.motion_B.yaw_rad, track.length_m,
                             track.width_m};
      const Eigen::Vector2d ego = Eigen::Vector2d::Zero();
      card_.lorry.near_face_m.Add(listed.DistanceTo(ego) - truth.box_B.DistanceTo(ego));
      card_.lorry.length_error_m.Add(track.length_m - object.length_m);
    }
    const Eigen::Vector2d velocity = track.motion_B.direction() * track.motion_B.speed_mps;
    card_.velocity_mps.Add(
        (velocity - truth.motion_B.direction() * truth.motion_B.speed_mps).norm());
    (truth.is_moving() ? card_.yaw_moving_rad : card_.yaw_standing_rad)
        .Add(std::abs(WrapAngle(track.motion_B.yaw_rad - truth.motion_B.yaw_rad)));
  }

  const RunLog& log_;
  const ScorecardSettings& settings_;
  Scorecard card_;
  std::map<std::size_t, Sight> sight_;              // Per object.
  std::map<std::size_t, std::int64_t> last_track_;  // Per object.
  std::map<std::int64_t, double> unseen_;           // Per track: seconds coasted.
};

double PerList(std::int64_t count, std::int64_t instants) {
  return instants > 0 ? static_cast<double>(count) / static_cast<double>(instants) : kNoValue;
}

}  // namespace

double Scorecard::false_per_list() const { return PerList(false_entries, instants); }
double Scorecard::Missed::share() const { return PerList(missed, of); }

Scorecard JudgeScorecard(const RunLog& log, ListKind kind, const ScorecardSettings& settings) {
  const std::vector<Scene> scenes = MakeScenes(log, kind, settings);
  Judge judge(log, kind, settings);
  for (const Scene& scene : scenes) judge.Take(scene);
  return judge.Finish(scenes);
}

Scorecards JudgeScorecards(const RunLog& log, const ScorecardSettings& settings) {
  return {JudgeScorecard(log, ListKind::kLocal, settings),
          JudgeScorecard(log, ListKind::kPriority, settings)};
}

}  // namespace v2vouch::evaluation
