// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/tgospa.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "daemon/common/assignment/assignment.h"
#include "daemon/common/base/check.h"
#include "sim/metrics/gospa.h"
#include "sim/metrics/path_refinement.h"
#include "sim/metrics/trajectory_problem.h"

namespace v2vouch::evaluation {
namespace {

using tgospa::Cluster;
using tgospa::Costs;
using tgospa::Matching;
using tgospa::Problem;

/// All partial matchings over the allowed pairs, in lexicographic order; stops past `limit`.
void Enumerate(const Cluster& cluster, std::size_t limit, Matching& current, std::size_t a,
               std::vector<char>& used, std::vector<Matching>& out) {
  if (out.size() > limit) return;
  if (a == cluster.truths.size()) {
    out.push_back(current);
    return;
  }
  current[a] = -1;
  Enumerate(cluster, limit, current, a + 1, used, out);
  for (std::size_t b = 0; b < cluster.tracks.size(); ++b) {
    if (used[b] || !cluster.allowed[a * cluster.tracks.size() + b]) continue;
    used[b] = 1;
    current[a] = static_cast<int>(b);
    Enumerate(cluster, limit, current, a + 1, used, out);
    used[b] = 0;
  }
  current[a] = -1;
}

std::vector<Matching> ExactPath(const Problem& problem, const Cluster& cluster,
                                const std::vector<Matching>& states) {
  const std::size_t count = states.size();
  std::vector<double> transition(count * count);
  for (std::size_t from = 0; from < count; ++from) {
    for (std::size_t to = 0; to < count; ++to) {
      transition[to * count + from] = problem.SwitchCost(states[from], states[to]);
    }
  }
  std::vector<double> best(count), next(count);
  std::vector<std::uint16_t> back(problem.steps() * count, 0);
  for (std::size_t s = 0; s < count; ++s) best[s] = problem.AddStep(cluster, states[s], 0, nullptr);
  for (std::size_t t = 1; t < problem.steps(); ++t) {
    for (std::size_t to = 0; to < count; ++to) {
      std::size_t argument = 0;
      double value = best[0] + transition[to * count];
      for (std::size_t from = 1; from < count; ++from) {
        const double candidate = best[from] + transition[to * count + from];
        if (candidate < value) {
          value = candidate;
          argument = from;
        }
      }
      next[to] = value + problem.AddStep(cluster, states[to], t, nullptr);
      back[t * count + to] = static_cast<std::uint16_t>(argument);
    }
    best.swap(next);
  }
  auto state = static_cast<std::size_t>(std::min_element(best.begin(), best.end()) - best.begin());
  std::vector<Matching> path(problem.steps());
  for (std::size_t t = problem.steps(); t-- > 0;) {
    path[t] = states[state];
    state = back[t * count + state];
  }
  return path;
}

class Beam {
 public:
  Beam(const Problem& problem, const Cluster& cluster, std::size_t width)
      : problem_(problem), cluster_(cluster), width_(width) {}

  std::vector<Matching> Path() {
    struct Node {
      Matching matching;
      std::size_t parent;
      double cost;
    };
    std::vector<std::vector<Node>> layers(problem_.steps());
    for (std::size_t t = 0; t < problem_.steps(); ++t) {
      std::vector<Node> candidates;
      const auto consider = [&](Matching matching, std::size_t parent) {
        double cost = problem_.AddStep(cluster_, matching, t, nullptr);
        if (t > 0) {
          const Node& before = layers[t - 1][parent];
          cost += before.cost + problem_.SwitchCost(before.matching, matching);
        }
        candidates.push_back({std::move(matching), parent, cost});
      };
      const Matching free = BestSuccessor(nullptr, t);
      if (t == 0) {
        consider(free, 0);
        consider(Matching(cluster_.truths.size(), -1), 0);
      }
      for (std::size_t k = 0; t > 0 && k < layers[t - 1].size(); ++k) {
        consider(free, k);
        consider(layers[t - 1][k].matching, k);
        consider(BestSuccessor(&layers[t - 1][k].matching, t), k);
      }
      std::sort(candidates.begin(), candidates.end(), [](const Node& a, const Node& b) {
        return a.matching != b.matching ? a.matching < b.matching
                                        : std::pair(a.cost, a.parent) < std::pair(b.cost, b.parent);
      });
      candidates.erase(
          std::unique(candidates.begin(), candidates.end(),
                      [](const Node& a, const Node& b) { return a.matching == b.matching; }),
          candidates.end());
      std::stable_sort(candidates.begin(), candidates.end(),
                       [](const Node& a, const Node& b) { return a.cost < b.cost; });
      if (candidates.size() > width_) candidates.resize(width_);
      layers[t] = std::move(candidates);
    }
    std::vector<Matching> path(problem_.steps());
    std::size_t k = 0;
    for (std::size_t t = problem_.steps(); t-- > 0;) {
      path[t] = layers[t][k].matching;
      k = layers[t][k].parent;
    }
    return path;
  }

 private:
  /// The matching of step t that is cheapest after `before`: switching costs are a sum over
  /// truths, so they go into the assignment's own costs. Null: as if switching were free.
  Matching BestSuccessor(const Matching* before, std::size_t t) {
    const std::size_t n = cluster_.truths.size();
    const std::size_t m = cluster_.tracks.size();
    const Costs& costs = problem_.costs();
    const auto switch_cost = [&](std::size_t a, int to) {
      if (before == nullptr || (*before)[a] == to) return 0.0;
      return (*before)[a] >= 0 && to >= 0 ? costs.full : costs.full / 2.0;
    };
    // Tracks that are neither here now nor held before gain nothing: leave them out.
    columns_.clear();
    for (std::size_t b = 0; b < m; ++b) {
      const bool is_held = before != nullptr && std::find(before->begin(), before->end(),
                                                          static_cast<int>(b)) != before->end();
      if (is_held || problem_.TrackExists(cluster_.tracks[b], t)) columns_.push_back(b);
    }
    cost_.assign(n * columns_.size(), kForbidden);
    lone_.assign(n, 0.0);
    for (std::size_t a = 0; a < n; ++a) {
      lone_[a] = switch_cost(a, -1);
      for (std::size_t k = 0; k < columns_.size(); ++k) {
        const std::size_t b = columns_[k];
        if (!cluster_.allowed[a * m + b]) continue;
        // Relative to both staying alone, which is a constant of the step.
        const double d = problem_.PairPower(cluster_.truths[a], cluster_.tracks[b], t);
        const double gain = d < costs.pair_max ? d - costs.pair_max : 0.0;
        cost_[a * columns_.size() + k] = gain + switch_cost(a, static_cast<int>(b));
      }
    }
    const auto solution = solver_.Solve(cost_, n, columns_.size(), lone_);
    Matching matching(n, -1);
    for (std::size_t a = 0; a < n; ++a) {
      if (solution[a] >= 0) {
        matching[a] = static_cast<int>(columns_[static_cast<std::size_t>(solution[a])]);
      }
    }
    return matching;
  }

  const Problem& problem_;
  const Cluster& cluster_;
  std::size_t width_;
  AssignmentSolver solver_;
  std::vector<double> cost_, lone_;
  std::vector<std::size_t> columns_;
};

}  // namespace

TrajectoryGospaResult TrajectoryGospa(const std::vector<Trajectory>& truths,
                                      const std::vector<Trajectory>& tracks,
                                      const TrajectoryGospaParameters& parameters) {
  const Problem problem(truths, tracks, parameters);
  for (const auto& trajectory : truths) V2VOUCH_CHECK(trajectory.size() == problem.steps());
  for (const auto& trajectory : tracks) V2VOUCH_CHECK(trajectory.size() == problem.steps());
  const std::size_t limit = std::min<std::size_t>(parameters.exact_states, UINT16_MAX);

  TrajectoryGospaResult result;
  for (const Cluster& cluster : problem.Clusters()) {
    std::vector<Matching> states;
    Matching current(cluster.truths.size(), -1);
    std::vector<char> used(cluster.tracks.size(), 0);
    Enumerate(cluster, limit, current, 0, used, states);
    const bool is_small = states.size() <= limit;
    std::vector<Matching> path = is_small ? ExactPath(problem, cluster, states)
                                          : Beam(problem, cluster, parameters.beam).Path();
    if (!is_small) Refine(problem, cluster, path);
    result.is_exact = result.is_exact && is_small;
    for (std::size_t t = 0; t < path.size(); ++t) {
      problem.AddStep(cluster, path[t], t, &result);
      if (t > 0) result.switch_pow += problem.SwitchCost(path[t - 1], path[t]);
    }
  }
  result.power = result.localisation_pow + result.missed_pow + result.false_pow + result.switch_pow;
  result.tgospa = Root(result.power, parameters.order);
  return result;
}

}  // namespace v2vouch::evaluation
