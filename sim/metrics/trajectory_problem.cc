// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/trajectory_problem.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "daemon/common/assignment/assignment.h"

namespace v2vouch::evaluation::tgospa {

Problem::Problem(const std::vector<Trajectory>& truths, const std::vector<Trajectory>& tracks,
                 const TrajectoryGospaParameters& parameters)
    : truths_(truths), tracks_(tracks), parameters_(parameters) {
  const double c_pow = std::pow(parameters.cutoff_m, parameters.order);
  costs_ = {c_pow, c_pow / 2.0, std::pow(parameters.switch_m, parameters.order)};
  steps_ = truths.empty() ? (tracks.empty() ? 0 : tracks.front().size()) : truths.front().size();
}

double Problem::PairPower(std::size_t truth, std::size_t track, std::size_t t) const {
  const Eigen::Vector2d& x = truths_[truth][t];
  const Eigen::Vector2d& y = tracks_[track][t];
  if (!IsPresent(x) || !IsPresent(y)) return kForbidden;
  const Eigen::Vector2d d = (x - y).cwiseAbs();
  if (parameters_.base == BaseDistance::kEuclidean) return std::pow(d.norm(), parameters_.order);
  return std::pow(d.x(), parameters_.order) + std::pow(d.y(), parameters_.order);
}

std::vector<Cluster> Problem::Clusters() const {
  const std::size_t n = truths_.size();
  const std::size_t m = tracks_.size();
  std::vector<char> close(n * m, 0);
  std::vector<std::size_t> parent(n + m);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      for (std::size_t t = 0; t < steps_ && !close[i * m + j]; ++t) {
        if (PairPower(i, j, t) < costs_.pair_max) close[i * m + j] = 1;
      }
      if (close[i * m + j]) parent[root(n + j)] = root(i);
    }
  }
  std::vector<Cluster> clusters;
  for (std::size_t r = 0; r < n + m; ++r) {
    if (root(r) != r) continue;
    Cluster cluster;
    for (std::size_t i = 0; i < n; ++i) {
      if (root(i) == r) cluster.truths.push_back(i);
    }
    for (std::size_t j = 0; j < m; ++j) {
      if (root(n + j) == r) cluster.tracks.push_back(j);
    }
    for (const std::size_t i : cluster.truths) {
      for (const std::size_t j : cluster.tracks) cluster.allowed.push_back(close[i * m + j]);
    }
    cluster.present.assign(steps_, 0);
    for (const std::size_t j : cluster.tracks) {
      for (std::size_t t = 0; t < steps_; ++t) cluster.present[t] += TrackExists(j, t) ? 1 : 0;
    }
    clusters.push_back(std::move(cluster));
  }
  return clusters;
}

double Problem::AddStep(const Cluster& cluster, const Matching& matching, std::size_t t,
                        TrajectoryGospaResult* sum) const {
  double localisation = 0.0;
  int missed = 0;
  int false_tracks = cluster.present[t];
  for (std::size_t a = 0; a < cluster.truths.size(); ++a) {
    const bool exists = TruthExists(cluster.truths[a], t);
    missed += exists ? 1 : 0;
    if (!exists || matching[a] < 0) continue;
    const double d =
        PairPower(cluster.truths[a], cluster.tracks[static_cast<std::size_t>(matching[a])], t);
    if (!(d < costs_.pair_max)) continue;
    localisation += d;
    --missed;
    --false_tracks;
  }
  if (sum != nullptr) {
    sum->localisation_pow += localisation;
    sum->missed_pow += missed * costs_.lone;
    sum->false_pow += false_tracks * costs_.lone;
  }
  return localisation + (missed + false_tracks) * costs_.lone;
}

double Problem::SwitchCost(const Matching& from, const Matching& to) const {
  double cost = 0.0;
  for (std::size_t a = 0; a < from.size(); ++a) {
    if (from[a] == to[a]) continue;
    cost += from[a] >= 0 && to[a] >= 0 ? costs_.full : costs_.full / 2.0;
  }
  return cost;
}

}  // namespace v2vouch::evaluation::tgospa
