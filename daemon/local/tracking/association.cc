// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/association.h"

#include <algorithm>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/chi_square.h"

namespace v2vouch {
namespace {

const double kLog2Pi = std::log(2.0 * kPi);
// For the choice of an assignment a young track counts at least this much, so that its second hit
// reaches it and does not start another track beside it. Existence itself uses the true value.
constexpr double kAssignmentExistence = 0.05;
// A track just outside of a sensor's view may still be seen by it.
constexpr double kMinDetection = 0.02;
constexpr double kSureExistence = 0.9999;
// Likelihood ratios above exp(this) are certain; more would overflow.
constexpr double kMostLogRatio = 200.0;
// Most that one frame adds to a listed track's odds of existence. What reflects once shows again
// and again (a wall's echo, a multipath ghost): a hit is no independent proof, and a track that is
// met in one frame of four must go down.
constexpr double kMostGain = 5.0;

}  // namespace

Association::Association(const TrackerConfig& config) : expected_(config.miss_memory_s) {
  for (int rows = 1; rows <= Linearized::kMaxRows; ++rows) {
    gate_[static_cast<std::size_t>(rows)] = ChiSquareQuantile(config.gate_probability, rows);
  }
}

void Association::Begin(SensorKey sensor, const DetectabilityOf& detectability, TrackTable& table) {
  candidates_.Clear();
  costs_.clear();
  pairs_.clear();
  expected_.Ask(sensor, detectability, table);
}

void Association::AddPair(const LocalTrack& track, std::size_t i, std::size_t j,
                          const Likelihood& likelihood, double log_cells) {
  if (likelihood.distance_squared > gate_[static_cast<std::size_t>(likelihood.rows)]) return;
  const double log_likelihood =
      -0.5 * (likelihood.distance_squared + likelihood.log_det + likelihood.rows * kLog2Pi);
  const double detection = std::max(expected_.detection(i), kMinDetection);
  const double log_ratio =
      log_likelihood + std::log(detection) - candidates_[j].log_density - log_cells;
  const double counted = std::max(track.existence, kAssignmentExistence);
  // Cost against leaving the track alone and calling the measurement clutter or a newcomer.
  const double cost = -(log_ratio + std::log(counted) -
                        std::log(1.0 - counted * std::max(expected_.missing(i), kMinDetection)));
  const int row = static_cast<int>(i);
  const int column = static_cast<int>(j);
  costs_.push_back({row, column, cost});
  pairs_.push_back({row, column, track.existence * std::exp(std::min(log_ratio, kMostLogRatio))});
}

void Association::Solve(std::size_t measurements, Proof proof, TrackTable& table) {
  lone_.assign(table.size(), 0.0);
  const auto best = solver_.Solve(costs_, table.size(), measurements, lone_);
  assigned_.assign(best.begin(), best.end());
  marginals_.Compute(pairs_, expected_.missed(), assigned_, measurements);
  for (std::size_t i = 0; i < table.size(); ++i) {
    LocalTrack& track = table[i].track;
    const double seen = marginals_.detected()[i];
    const double unseen = ExistenceAfterMiss(track.existence, expected_.missing(i));
    double next = std::min(seen + (1.0 - seen) * unseen, kSureExistence);
    if (proof == Proof::kRepeated && track.is_confirmed) {
      const double odds = kMostGain * track.existence / (1.0 - track.existence);
      next = std::min(next, odds / (1.0 + odds));
    }
    track.existence = next;
  }
}

}  // namespace v2vouch
