// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/honest_treatment.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <v2vouch/track_t.hpp>

#include "sim/metrics/bound.h"
#include "sim/metrics/gospa.h"
#include "sim/metrics/placing.h"
#include "sim/metrics/scoring.h"
#include "sim/metrics/sight.h"
#include "sim/spoofing/joint_view.h"

namespace v2vouch::evaluation {
namespace {

constexpr double kLongestSilence_s = 2.0;
constexpr double kGlimpse_s = 0.5;
constexpr double kAfterBridge_s = 1.0;
constexpr double kMatch_m = 10.0;

/// Where one vehicle and the track on it were at one instant.
struct Cell {
  bool is_there = false;
  bool is_present = false;  // ... and within the disc.
  bool is_hidden = false;
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
};

/// A PRIORITY track at one instant.
struct Listed {
  std::int64_t id = 0;
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
  double budget_s = 0.0;  // As published; NaN: none applies.
};

/// Since when both kinds of sensors have seen each vehicle.
class Views {
 public:
  explicit Views(const RunLog& log) {
    for (const TruthObject& object : log.truth.objects) {
      Seen& seen = seen_[object.id];
      seen.samples = &object.motion.samples();
      std::optional<Timestamp> since;
      for (const TruthSample& sample : object.motion.samples()) {
        if (!IsSeenByEnough(sample, log.specs)) {
          since.reset();
        } else if (!since) {
          since = sample.stamp;
        }
        seen.long_enough.push_back(since && ToSeconds(sample.stamp - *since) >= kEligibleAfter_s);
      }
    }
  }

  [[nodiscard]] bool IsSeen(std::int64_t vehicle, Timestamp t) const {
    const auto found = seen_.find(vehicle);
    if (found == seen_.end()) return false;
    const std::vector<TruthSample>& samples = *found->second.samples;
    const auto after = std::ranges::upper_bound(samples, t, {}, &TruthSample::stamp);
    if (after == samples.begin()) return false;
    return found->second.long_enough[static_cast<std::size_t>(after - samples.begin() - 1)];
  }

 private:
  struct Seen {
    const std::vector<TruthSample>* samples = nullptr;
    std::vector<bool> long_enough;  // By sample.
  };
  std::map<std::int64_t, Seen> seen_;  // By vehicle.
};

/// Adds up the time honest devices were heard and mistrusted, and who was relied on in view.
void TakeMessages(const RunLog& log, const Senders& senders,
                  const std::vector<JudgedMessage>& judged, HonestTreatment& result) {
  std::map<std::int64_t, Timestamp> last;
  const Views views(log);
  for (const JudgedMessage& message : judged) {
    const BsmTruth& m = log.bsm_truths[message.truth];
    if (senders.IsAttacker(m.device)) continue;
    const auto ego = log.truth.ego.At(m.stamp);
    if (!ego || !m.honest.p_W.allFinite()) continue;
    const double distance_m = (m.honest.p_W - ego->position()).norm();
    if (distance_m > HonestTreatment::kHeard_m) continue;
    const bool is_near =
        distance_m >= JointView::kNearest_m && distance_m <= JointView::kFarthest_m;
    const bool is_seen = is_near && views.IsSeen(m.vehicle, m.stamp);
    if (is_seen && message.has_verdict && !message.is_contested) {
      ++result.in_view;
      result.validated += message.is_relied_on ? 1 : 0;
    }
    const auto [before, is_new] = last.try_emplace(m.device, m.stamp);
    const double gap_s = is_new ? 0.0 : ToSeconds(m.stamp - before->second);
    before->second = m.stamp;
    if (gap_s > kLongestSilence_s) continue;
    result.vehicle_s += gap_s;
    // A refused message says nothing of the sender.
    if (message.is_mistrusted) result.withdrawn_s += gap_s;
  }
  result.senders = static_cast<int>(last.size());
}

void TakeReports(const RunLog& log, const Senders& senders, HonestTreatment& result) {
  std::set<std::int64_t> accused;
  for (const VerdictReport& report : log.reports) {
    if (senders.AttackerMeant(report.sender, report.received)) continue;
    const auto device = senders.HonestUser(report.sender);
    if (!device) continue;
    ++(report.is_accusation ? result.accusations : result.withdrawals);
    if (report.is_accusation) accused.insert(*device);
  }
  result.accused = static_cast<int>(accused.size());
}

/// Follows PRIORITY along the grid.
class Follower {
 public:
  Follower(const RunLog& log, const Senders& senders) : log_(log) {
    ScoringSettings settings;
    grid_ = MakeGrid(log.truth, settings);
    period_s_ = settings.period_s;
    // An attacker's own vehicle may well be withdrawn.
    std::set<std::int64_t> attacked;
    std::set<std::int64_t> heard;
    for (const BsmTruth& m : log.bsm_truths) {
      if (senders.IsAttacker(m.device)) attacked.insert(m.vehicle);
      heard.insert(m.vehicle);
    }
    for (std::size_t o = 0; o < log.truth.objects.size(); ++o) {
      const TruthObject& object = log.truth.objects[o];
      if (!object.is_vehicle() || !object.has_v2v) continue;
      vehicles_.push_back(o);
      is_honest_.push_back(heard.contains(object.id) && !attacked.contains(object.id));
    }
  }

  void Judge(HonestTreatment& result) {
    if (grid_.empty() || vehicles_.empty()) return;
    Place();
    Hold(result);
    for (std::size_t v = 0; v < vehicles_.size(); ++v) {
      if (is_honest_[v]) Bridge(v, result);
    }
  }

 private:
  [[nodiscard]] const Cell& At(std::size_t vehicle, std::size_t k) const {
    return cells_[vehicle * grid_.size() + k];
  }

  void Place() {
    cells_.resize(vehicles_.size() * grid_.size());
    tracks_.resize(grid_.size());
    for (std::size_t k = 0; k < grid_.size(); ++k) {
      const Timestamp t = grid_[k];
      const auto ego = log_.truth.ego.At(t);
      for (std::size_t v = 0; ego && v < vehicles_.size(); ++v) {
        const TruthObject& object = log_.truth.objects[vehicles_[v]];
        const auto motion = object.motion.At(t);
        if (!motion) continue;
        Cell& cell = cells_[v * grid_.size() + k];
        cell.is_there = true;
        cell.p_W = motion->position();
        cell.is_present = (cell.p_W - ego->position()).norm() <= HonestTreatment::kDisc_m;
        cell.is_hidden = object.motion.InForce(t)->is_hidden;
      }
      const auto placed = PlaceTracks(log_, NewestBy(log_.lists[Index(ListKind::kPriority)], t),
                                      ListKind::kPriority, t);
      for (const PlacedTrack& track : placed) {
        tracks_[k].push_back(
            {track.track->id, track.motion_W.position(), track.track->bridge_budget_s});
      }
    }
  }

  void Hold(HonestTreatment& result) {
    const Bound bound(log_, grid_, {.only_senders = true});
    Gospa gospa({.cutoff_m = kMatch_m});
    std::vector<Eigen::Vector2d> truths, tracks;
    std::vector<std::size_t> there;
    for (std::size_t k = 0; k < grid_.size(); ++k) {
      truths.clear();
      tracks.clear();
      there.clear();
      for (std::size_t v = 0; v < vehicles_.size(); ++v) {
        if (!At(v, k).is_there) continue;
        truths.push_back(At(v, k).p_W);
        there.push_back(v);
      }
      for (const Listed& track : tracks_[k]) tracks.push_back(track.p_W);
      const std::vector<int>& assignment = gospa.FromPoints(truths, tracks).assignment;
      for (std::size_t i = 0; i < there.size(); ++i) {
        const std::size_t v = there[i];
        if (!is_honest_[v] || !At(v, k).is_present) continue;
        if (!bound.At(ListKind::kPriority, vehicles_[v], k).is_held) continue;
        result.holdable_s += period_s_;
        if (assignment[i] >= 0) result.held_s += period_s_;
      }
    }
  }

  [[nodiscard]] bool IsOnTrack(std::int64_t id, std::size_t v, std::size_t k) const {
    const auto track = std::ranges::find(tracks_[k], id, &Listed::id);
    return track != tracks_[k].end() &&
           (track->p_W - At(v, k).p_W).norm() < HonestTreatment::kBridgeError_m;
  }

  void Bridge(std::size_t v, HonestTreatment& result) const {
    const auto steps = [&](double seconds) {
      return static_cast<std::size_t>(std::lround(seconds / period_s_));
    };
    for (std::size_t k = 1; k < grid_.size(); ++k) {
      if (!At(v, k).is_hidden || At(v, k - 1).is_hidden) continue;
      const std::size_t from = k;
      std::size_t glimpse = 0;
      std::size_t to = k;  // One past the last hidden instant.
      for (; k < grid_.size() && glimpse < steps(kGlimpse_s); ++k) {
        glimpse = At(v, k).is_hidden ? 0 : glimpse + 1;
        if (At(v, k).is_hidden) to = k + 1;
      }
      if (glimpse < steps(kGlimpse_s)) return;  // The run ends hidden.
      JudgeStretch(v, from, to, to + steps(kAfterBridge_s), result);
    }
  }

  void JudgeStretch(std::size_t v, std::size_t from, std::size_t to, std::size_t after,
                    HonestTreatment& result) const {
    const double hidden_s = static_cast<double>(to - from) * period_s_;
    if (hidden_s < HonestTreatment::kBridgeFrom_s || hidden_s > HonestTreatment::kBridgeTo_s)
      return;
    for (std::size_t k = from - 1; k <= to && k < grid_.size(); ++k) {
      if (!At(v, k).is_present) return;
    }
    const Listed* held = nullptr;
    double least_m = HonestTreatment::kBridgeError_m;
    for (const Listed& track : tracks_[from - 1]) {
      const double error_m = (track.p_W - At(v, from - 1).p_W).norm();
      if (error_m >= least_m) continue;
      least_m = error_m;
      held = &track;
    }
    if (held == nullptr) return;
    const bool is_in_budget = !(held->budget_s < hidden_s);
    ++result.bridges;
    result.bridges_in_budget += is_in_budget ? 1 : 0;
    for (std::size_t k = from; k < to; ++k) {
      if (!IsOnTrack(held->id, v, k)) return;
    }
    ++result.bridges_survived;
    result.survived_in_budget += is_in_budget ? 1 : 0;
    if (after < grid_.size() && IsOnTrack(held->id, v, after)) ++result.bridges_same_id;
  }

  const RunLog& log_;
  std::vector<Timestamp> grid_;
  double period_s_ = 0.05;
  std::vector<std::size_t> vehicles_;        // With V2V: indices into Truth::objects.
  std::vector<bool> is_honest_;              // ... and heard, and no attacker speaks for it.
  std::vector<Cell> cells_;                  // vehicles x grid.
  std::vector<std::vector<Listed>> tracks_;  // By instant.
};

}  // namespace

void HonestTreatment::Add(const HonestTreatment& other) {
  vehicle_s += other.vehicle_s;
  withdrawn_s += other.withdrawn_s;
  accusations += other.accusations;
  withdrawals += other.withdrawals;
  senders += other.senders;
  accused += other.accused;
  in_view += other.in_view;
  validated += other.validated;
  holdable_s += other.holdable_s;
  held_s += other.held_s;
  bridges += other.bridges;
  bridges_survived += other.bridges_survived;
  bridges_same_id += other.bridges_same_id;
  bridges_in_budget += other.bridges_in_budget;
  survived_in_budget += other.survived_in_budget;
}

HonestTreatment JudgeHonest(const RunLog& log, const Senders& senders,
                            const std::vector<JudgedMessage>& judged) {
  HonestTreatment result;
  TakeMessages(log, senders, judged, result);
  TakeReports(log, senders, result);
  Follower(log, senders).Judge(result);
  return result;
}

}  // namespace v2vouch::evaluation
