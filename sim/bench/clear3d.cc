// SPDX-License-Identifier: Apache-2.0
#include "sim/bench/clear3d.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "daemon/common/assignment/assignment.h"

namespace v2vouch::bench {
namespace {

constexpr int kRecalls = 40;
constexpr double kLeastHeight_px = 25.0;
constexpr double kMostUnlabelled = 0.5;

// A frame with what does not depend on the threshold of the score.
struct Prepared {
  const EvaluatedFrame* frame = nullptr;
  std::vector<double> iou;    // Row-major truths x tracked.
  std::vector<double> score;  // Of each row's track: the mean over all its rows.
  std::vector<bool> may_be_false;
};

std::vector<Prepared> Prepare(const EvaluatedSequence& sequence) {
  std::map<std::uint64_t, std::pair<double, int>> sums;
  for (const EvaluatedFrame& frame : sequence) {
    for (const TrackedBox& row : frame.tracked) {
      sums[row.id].first += row.score;
      ++sums[row.id].second;
    }
  }
  std::vector<Prepared> prepared;
  for (const EvaluatedFrame& frame : sequence) {
    Prepared now;
    now.frame = &frame;
    for (const TruthBox& truth : frame.truth) {
      for (const TrackedBox& row : frame.tracked) now.iou.push_back(Iou3d(truth.box, row.box));
    }
    for (const TrackedBox& row : frame.tracked) {
      const auto& [sum, count] = sums[row.id];
      now.score.push_back(sum / count);
      const bool is_unlabelled = std::ranges::any_of(frame.regions, [&](const PixelBox& region) {
        return CoveredShare(row.pixels, region) > kMostUnlabelled;
      });
      now.may_be_false.push_back(row.pixels.height() > kLeastHeight_px && !is_unlabelled);
    }
    prepared.push_back(std::move(now));
  }
  return prepared;
}

void AddNees(const TruthBox& truth, const TrackedBox& row, ClearCounts& counts) {
  if (!row.covariance) return;
  const Eigen::Vector2d e(row.box.x_m - truth.box.x_m, row.box.y_m - truth.box.y_m);
  const double nees = 0.5 * e.dot(row.covariance->inverse() * e);
  if (!std::isfinite(nees)) return;
  counts.nees_sum += nees;
  ++counts.nees_count;
}

class Counter {
 public:
  explicit Counter(double iou) : iou_(iou) {}

  void Add(const std::vector<Prepared>& sequence, double least_score, ClearCounts& counts,
           std::vector<double>* hit_scores) {
    last_.clear();
    for (const Prepared& now : sequence) Look(now, least_score, counts, hit_scores);
  }

 private:
  struct Holder {
    std::uint64_t track = 0;
    bool is_held = true;
  };

  void Look(const Prepared& now, double least_score, ClearCounts& counts,
            std::vector<double>* hit_scores) {
    const auto& truth = now.frame->truth;
    const auto& rows = now.frame->tracked;
    cost_.assign(truth.size() * rows.size(), kForbidden);
    for (std::size_t i = 0; i < cost_.size(); ++i) {
      if (now.score[i % rows.size()] >= least_score && now.iou[i] > iou_)
        cost_[i] = 1.0 - now.iou[i];
    }
    lone_.assign(truth.size(), 1.0 - iou_);
    const auto pairs = solver_.Solve(cost_, truth.size(), rows.size(), lone_);
    is_taken_.assign(rows.size(), false);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const bool counts_here = !truth[i].is_ignored;
      counts.truths += counts_here ? 1 : 0;
      const auto held = last_.find(truth[i].id);
      if (pairs[i] < 0) {
        if (!counts_here) continue;
        ++counts.misses;
        if (held != last_.end()) held->second.is_held = false;
        continue;
      }
      const auto j = static_cast<std::size_t>(pairs[i]);
      is_taken_[j] = true;
      if (counts_here) {
        ++counts.hits;
        counts.iou_sum += now.iou[i * rows.size() + j];
        AddNees(truth[i], rows[j], counts);
        if (hit_scores != nullptr) hit_scores->push_back(now.score[j]);
        if (held != last_.end()) {
          counts.switches += held->second.track != rows[j].id ? 1 : 0;
          counts.fragments += held->second.is_held ? 0 : 1;
        }
      }
      last_[truth[i].id] = {rows[j].id, true};
    }
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const bool is_false = now.score[j] >= least_score && !is_taken_[j] && now.may_be_false[j];
      counts.false_boxes += is_false ? 1 : 0;
    }
  }

  double iou_;
  AssignmentSolver solver_;
  std::vector<double> cost_, lone_;
  std::vector<bool> is_taken_;
  std::map<int, Holder> last_;  // By truth.
};

}  // namespace

double ClearCounts::mota() const {
  return truths > 0 ? 1.0 - static_cast<double>(false_boxes + misses + switches) / truths : NAN;
}
double ClearCounts::motp() const { return hits > 0 ? iou_sum / hits : NAN; }
double ClearCounts::anees() const { return nees_count > 0 ? nees_sum / nees_count : NAN; }

Clear3dFigures EvaluateClear3d(std::span<const EvaluatedSequence> sequences, double iou) {
  std::vector<std::vector<Prepared>> prepared;
  for (const EvaluatedSequence& sequence : sequences) prepared.push_back(Prepare(sequence));
  Counter counter(iou);
  const auto count = [&](double least_score, std::vector<double>* hit_scores) {
    ClearCounts counts;
    for (const auto& sequence : prepared) counter.Add(sequence, least_score, counts, hit_scores);
    return counts;
  };
  std::vector<double> scores;
  const ClearCounts all = count(-std::numeric_limits<double>::infinity(), &scores);
  std::ranges::sort(scores, std::greater<>());
  Clear3dFigures figures;
  figures.best = all;
  bool is_first = true;
  for (int k = 1; k <= kRecalls && all.truths > 0; ++k) {
    const double recall = static_cast<double>(k) / kRecalls;
    const auto needed = static_cast<std::size_t>(std::ceil(recall * all.truths));
    if (needed > scores.size()) break;
    const ClearCounts counts = count(scores[needed - 1], nullptr);
    const double faults = counts.false_boxes + counts.misses + counts.switches;
    const double scaled =
        1.0 - (faults - (1.0 - recall) * counts.truths) / (recall * counts.truths);
    figures.amota += std::max(0.0, counts.mota()) / kRecalls;
    figures.samota += std::clamp(scaled, 0.0, 1.0) / kRecalls;
    if (is_first || counts.mota() > figures.best.mota()) figures.best = counts;
    is_first = false;
  }
  return figures;
}

}  // namespace v2vouch::bench
