// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "sim/metrics/tgospa.h"

namespace v2vouch::evaluation::tgospa {

/// Per truth of the cluster its track's position in the cluster, or -1.
using Matching = std::vector<int>;

struct Costs {
  double pair_max = 0.0;  // c^p
  double lone = 0.0;      // c^p / 2
  double full = 0.0;      // gamma^p
};

/// Everything a cluster needs: its members and d^p of every pair it may use at every step.
struct Cluster {
  std::vector<std::size_t> truths, tracks;
  std::vector<char> allowed;  // truths x tracks: ever closer than c
  std::vector<int> present;   // Tracks that exist, per step.
};

class Problem {
 public:
  Problem(const std::vector<Trajectory>& truths, const std::vector<Trajectory>& tracks,
          const TrajectoryGospaParameters& parameters);

  [[nodiscard]] std::size_t steps() const { return steps_; }
  [[nodiscard]] const Costs& costs() const { return costs_; }

  /// d^p of a pair with both present, otherwise infinity.
  [[nodiscard]] double PairPower(std::size_t truth, std::size_t track, std::size_t t) const;
  [[nodiscard]] bool TruthExists(std::size_t truth, std::size_t t) const {
    return IsPresent(truths_[truth][t]);
  }
  [[nodiscard]] bool TrackExists(std::size_t track, std::size_t t) const {
    return IsPresent(tracks_[track][t]);
  }

  /// Connected components of the "ever closer than c" graph. Members without a partner are in no
  /// cluster: they are missed or false at every step they exist.
  [[nodiscard]] std::vector<Cluster> Clusters() const;

  /// Adds one step of a matching to `sum` and returns its cost.
  double AddStep(const Cluster& cluster, const Matching& matching, std::size_t t,
                 TrajectoryGospaResult* sum) const;
  [[nodiscard]] double SwitchCost(const Matching& from, const Matching& to) const;

 private:
  static bool IsPresent(const Eigen::Vector2d& p) { return !std::isnan(p.x()); }

  const std::vector<Trajectory>& truths_;
  const std::vector<Trajectory>& tracks_;
  const TrajectoryGospaParameters& parameters_;
  Costs costs_;
  std::size_t steps_ = 0;
};

}  // namespace v2vouch::evaluation::tgospa
