// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/scoring.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "sim/metrics/consistency.h"
#include "sim/metrics/placing.h"

namespace v2vouch::evaluation {
namespace {

/// Gathers one list's figures instant by instant.
class Scorer {
 public:
  Scorer(const RunLog& log, const std::vector<Timestamp>& grid, const Bound& bound, ListKind kind,
         Against against, const ScoringSettings& settings)
      : log_(log),
        grid_(grid),
        bound_(bound),
        against_(against),
        settings_(settings),
        gospa_({.cutoff_m = settings.cutoff_m, .order = settings.order}) {
    score_.kind = kind;
    score_.has_lists = !log.lists[Index(kind)].empty();
    lone_pow_ = std::pow(settings.cutoff_m, settings.order) / 2.0;
  }

  void TakeInstant(std::size_t k) {
    const Timestamp t = grid_[k];
    const auto ego = log_.truth.ego.At(t);
    if (!ego) return;
    const Pose<World, Body> X_WB(ego->x_m, ego->y_m, ego->yaw_rad);
    const auto inside = [&](const Eigen::Vector2d& p) {
      return (p - ego->position()).norm() <= settings_.radius_m;
    };
    const ReceivedList* list = NewestBy(log_.lists[Index(score_.kind)], t);
    const std::vector<PlacedTrack> tracks = PlaceTracks(log_, list, score_.kind, t);
    const std::vector<PlacedTruth> truths = PlaceTruths(log_, score_.kind, against_, t, X_WB);
    truth_points_.clear();
    track_points_.clear();
    for (const auto& truth : truths) truth_points_.push_back(truth.p_W);
    for (const auto& track : tracks) track_points_.push_back(track.motion_W.position());
    const std::vector<int> assignment = gospa_.FromPoints(truth_points_, track_points_).assignment;

    InstantScore now;
    now.instant = k;
    now.t_s = ToSeconds(t - log_.truth.begin());
    std::vector<char> is_used(tracks.size(), 0);
    held_.clear();
    double bound_pow = 0.0;
    double plain_pow = 0.0;
    for (std::size_t i = 0; i < truths.size(); ++i) {
      const PlacedTruth& truth = truths[i];
      const int j = assignment[i];
      if (j >= 0) is_used[static_cast<std::size_t>(j)] = 1;
      if (!inside(truth.p_W)) continue;
      ++now.truths;
      const PlacedTrack* track = j < 0 ? nullptr : &tracks[static_cast<std::size_t>(j)];
      TakeTruth(k, truth, track, list, now);
      TakeBound(k, truth, track != nullptr, now, bound_pow, plain_pow);
    }
    for (std::size_t j = 0; j < tracks.size(); ++j) {
      if (is_used[j] || !inside(track_points_[j]) || IsRoadUser(track_points_[j], t)) continue;
      ++now.false_tracks;
      false_ids_.insert(tracks[j].track->id);
      RememberTrack(k, tracks[j]);
    }
    now.missed_pow = now.missed * lone_pow_;
    now.false_pow = now.false_tracks * lone_pow_;
    const double power = now.localisation_pow + now.missed_pow + now.false_pow;
    now.gospa = Root(power, settings_.order);
    const double switches = counter_.Step(held_);
    score_.switch_halves += switches;
    now.switching_pow = std::pow(settings_.switching(), settings_.order) * switches;
    now.bound_gospa = Root(bound_pow, settings_.order);
    plain_sum_ += Root(plain_pow, settings_.order);
    power_sum_ += now.gospa * now.gospa;
    score_.series.push_back(now);
  }

  ListScore Finish(bool with_trajectories) {
    const double count = std::max<double>(1.0, static_cast<double>(score_.series.size()));
    const double p = settings_.order;
    for (const InstantScore& now : score_.series) {
      score_.gospa_mean += now.gospa / count;
      score_.localisation_mean += Root(now.localisation_pow, p) / count;
      score_.missed_mean += Root(now.missed_pow, p) / count;
      score_.false_mean += Root(now.false_pow, p) / count;
      score_.switching_mean += Root(now.switching_pow, p) / count;
      score_.bound_mean += now.bound_gospa / count;
      score_.bound_missed_mean += Root(now.bound_missed_pow, p) / count;
      score_.false_instants += now.false_tracks;
      score_.vehicle_seconds += now.truths * settings_.period_s;
      score_.missed_seconds += now.missed * settings_.period_s;
    }
    score_.bound_mean_plain = plain_sum_ / count;
    score_.gospa_rms = std::sqrt(power_sum_ / count);
    score_.false_track_ids = static_cast<int>(false_ids_.size());
    score_.bound_missed_seconds = score_.vehicle_seconds - held_seconds_;
    const auto share = [](double part, double whole) {
      return whole > 0.0 ? part / whole : kNoValue;
    };
    score_.excess_missed_share = share(score_.excess_missed_seconds, held_seconds_);
    score_.excess_missed_visible_share = share(missed_visible_seconds_, held_visible_seconds_);
    score_.excess_missed_share_plain = share(missed_plain_seconds_, held_plain_seconds_);
    const auto rms = [](double sum, std::int64_t n) {
      return n > 0 ? std::sqrt(sum / static_cast<double>(n)) : kNoValue;
    };
    score_.localisation_rms_m = rms(visible_sum_, visible_count_);
    score_.localisation_all_rms_m = rms(all_sum_, static_cast<std::int64_t>(score_.pairs.size()));
    score_.localisation_ratio =
        bounded_variance_ > 0.0 ? std::sqrt(bounded_sum_ / bounded_variance_) : kNoValue;
    score_.localisation_extended_ratio =
        bounded_extended_ > 0.0 ? std::sqrt(bounded_sum_ / bounded_extended_) : kNoValue;
    for (const Sighting sighting : {Sighting::kVisible, Sighting::kHidden, Sighting::kOutOfView}) {
      SetBand(score_.pairs, sighting, AneesOf(sighting));
    }
    if (score_.has_lists && with_trajectories) ScoreTrajectories();
    if (!score_.has_lists || score_.series.empty()) {  // Nothing was said, right or wrong.
      for (double* mean :
           {&score_.gospa_mean, &score_.gospa_rms, &score_.localisation_mean, &score_.missed_mean,
            &score_.false_mean, &score_.switching_mean, &score_.excess_missed_share,
            &score_.excess_missed_visible_share, &score_.excess_missed_share_plain}) {
        *mean = kNoValue;
      }
    }
    if (score_.series.empty()) {
      score_.bound_mean = score_.bound_mean_plain = score_.bound_missed_mean = kNoValue;
    }
    return std::move(score_);
  }

 private:
  Anees& AneesOf(Sighting sighting) {
    return sighting == Sighting::kVisible  ? score_.visible
           : sighting == Sighting::kHidden ? score_.hidden
                                           : score_.out_of_view;
  }

  void TakeTruth(std::size_t k, const PlacedTruth& truth, const PlacedTrack* track,
                 const ReceivedList* list, InstantScore& now) {
    const TruthObject& object = log_.truth.objects[truth.object];
    truth_trajectories_[object.id].emplace_back(k, truth.p_W);
    if (track == nullptr) {
      ++now.missed;
      held_.push_back({object.id, SwitchCounter::kNoTrack});
      return;
    }
    held_.push_back({object.id, track->track->id});
    RememberTrack(k, *track);
    const double error = (truth.p_W - track->motion_W.position()).norm();
    now.localisation_pow += std::pow(error, settings_.order);
    const double nees = NeesAt(log_, object, *list, *track->track);
    score_.pairs.push_back({k, truth.object, track->track->id, error, nees, truth.sighting});
    if (!std::isnan(nees)) {
      Anees& anees = AneesOf(truth.sighting);
      anees.sum += nees;
      ++anees.count;
    }
    const auto [last, is_new] = last_track_.try_emplace(object.id, track->track->id);
    if (!is_new && last->second != track->track->id) {
      ++score_.switches;
      last->second = track->track->id;
    }
    all_sum_ += error * error;
    if (!truth.is_seen() && score_.kind != ListKind::kV2v) return;
    visible_sum_ += error * error;
    ++visible_count_;
    const BoundCell& cell = bound_.At(score_.kind, truth.object, k);
    if (!cell.is_held) return;
    bounded_sum_ += error * error;
    bounded_variance_ += cell.variance_m2;
    bounded_extended_ += cell.extended_variance_m2;
  }

  void TakeBound(std::size_t k, const PlacedTruth& truth, bool is_matched, InstantScore& now,
                 double& bound_pow, double& plain_pow) {
    const BoundCell& cell = bound_.At(score_.kind, truth.object, k);
    // Order 2 has a closed form; for another order the root mean square stands in.
    const double square = TruncatedSquare(cell.variance_m2, settings_.cutoff_m);
    const double held_pow = std::min(lone_pow_, std::pow(square, settings_.order / 2.0));
    bound_pow += cell.is_held ? held_pow : lone_pow_;
    plain_pow += cell.is_held_plain ? held_pow : lone_pow_;
    if (cell.is_held_plain) {
      held_plain_seconds_ += settings_.period_s;
      if (!is_matched) missed_plain_seconds_ += settings_.period_s;
    }
    if (!cell.is_held) {
      now.bound_missed_pow += lone_pow_;
      return;
    }
    held_seconds_ += settings_.period_s;
    if (truth.is_seen()) {
      held_visible_seconds_ += settings_.period_s;
      if (!is_matched) missed_visible_seconds_ += settings_.period_s;
    }
    if (!is_matched) score_.excess_missed_seconds += settings_.period_s;
  }

  /// LOCAL may list what is really a pedestrian or cyclist without a class.
  [[nodiscard]] bool IsRoadUser(const Eigen::Vector2d& p, Timestamp t) const {
    return score_.kind == ListKind::kLocal &&
           IsBesideRoadUser(log_.truth, p, t, settings_.cutoff_m);
  }

  void RememberTrack(std::size_t k, const PlacedTrack& track) {
    track_trajectories_[track.track->id].emplace_back(k, track.motion_W.position());
  }

  void ScoreTrajectories() {
    if (score_.series.empty()) return;
    const std::size_t first = score_.series.front().instant;
    const std::size_t steps = score_.series.back().instant - first + 1;
    const auto spread = [&](const Steps& all) {
      std::vector<Trajectory> out;
      for (const auto& [id, points] : all) {
        Trajectory trajectory(steps, Absent());
        for (const auto& [k, p] : points) trajectory[k - first] = p;
        out.push_back(std::move(trajectory));
      }
      return out;
    };
    score_.trajectory = TrajectoryGospa(spread(truth_trajectories_), spread(track_trajectories_),
                                        {.cutoff_m = settings_.cutoff_m,
                                         .order = settings_.order,
                                         .switch_m = settings_.switching(),
                                         .beam = 16});
    score_.trajectory_per_step =
        Root(score_.trajectory.power / static_cast<double>(steps), settings_.order);
  }

  const RunLog& log_;
  const std::vector<Timestamp>& grid_;
  const Bound& bound_;
  Against against_;
  const ScoringSettings& settings_;
  Gospa gospa_;
  SwitchCounter counter_;
  ListScore score_;
  double lone_pow_ = 0.0;
  double plain_sum_ = 0.0;
  double power_sum_ = 0.0;
  double held_seconds_ = 0.0;
  double held_visible_seconds_ = 0.0;
  double missed_visible_seconds_ = 0.0;
  double held_plain_seconds_ = 0.0;
  double missed_plain_seconds_ = 0.0;
  double visible_sum_ = 0.0;
  double all_sum_ = 0.0;
  double bounded_sum_ = 0.0;
  double bounded_variance_ = 0.0;
  double bounded_extended_ = 0.0;
  std::int64_t visible_count_ = 0;
  std::set<std::int64_t> false_ids_;
  std::map<std::int64_t, std::int64_t> last_track_;
  using Steps = std::map<std::int64_t, std::vector<std::pair<std::size_t, Eigen::Vector2d>>>;
  Steps truth_trajectories_, track_trajectories_;
  std::vector<Eigen::Vector2d> truth_points_, track_points_;
  std::vector<SwitchCounter::Held> held_;
};

}  // namespace

std::vector<Timestamp> MakeGrid(const Truth& truth, const ScoringSettings& settings) {
  std::vector<Timestamp> grid;
  if (truth.empty()) return grid;
  const Duration period = FromSeconds(settings.period_s);
  for (Timestamp t = truth.begin(); t <= truth.end(); t += period) grid.push_back(t);
  return grid;
}

ListScore ScoreList(const RunLog& log, const std::vector<Timestamp>& grid, const Bound& bound,
                    ListKind kind, Against against, const ScoringSettings& settings,
                    bool with_trajectories) {
  Scorer scorer(log, grid, bound, kind, against, settings);
  for (std::size_t k = 0; k < grid.size(); ++k) {
    if (ToSeconds(grid[k] - grid.front()) + 1e-9 < settings.skip_s) continue;
    scorer.TakeInstant(k);
  }
  return scorer.Finish(with_trajectories);
}

}  // namespace v2vouch::evaluation
