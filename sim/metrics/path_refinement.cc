// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/path_refinement.h"

#include <algorithm>

#include "daemon/common/assignment/assignment.h"

namespace v2vouch::evaluation::tgospa {
namespace {

// What a pair costs at step t relative to both staying alone; never above 0.
double GainOf(const Problem& problem, std::size_t truth, std::size_t track, std::size_t t) {
  const double d = problem.PairPower(truth, track, t);
  return d < problem.costs().pair_max ? d - problem.costs().pair_max : 0.0;
}

// The tracks that other truths than `a` hold.
void MarkTaken(const Matching& matching, std::size_t a, std::vector<char>& taken) {
  std::fill(taken.begin(), taken.end(), 0);
  for (std::size_t other = 0; other < matching.size(); ++other) {
    if (other != a && matching[other] >= 0) taken[static_cast<std::size_t>(matching[other])] = 1;
  }
}

// What truth `a` costs with its matchings in `path`, relative to staying alone throughout.
double CostOf(const Problem& problem, const Cluster& cluster, const std::vector<Matching>& path,
              std::size_t a) {
  const Costs& costs = problem.costs();
  double old_cost = 0.0;
  for (std::size_t t = 0; t < path.size(); ++t) {
    const int b = path[t][a];
    if (b >= 0) {
      const std::size_t track = cluster.tracks[static_cast<std::size_t>(b)];
      const double d = problem.PairPower(cluster.truths[a], track, t);
      if (d < costs.pair_max) old_cost += d - costs.pair_max;
    }
    if (t > 0 && path[t - 1][a] != b) {
      old_cost += path[t - 1][a] >= 0 && b >= 0 ? costs.full : costs.full / 2.0;
    }
  }
  return old_cost;
}

}  // namespace

void Refine(const Problem& problem, const Cluster& cluster, std::vector<Matching>& path) {
  constexpr int kRounds = 8;
  const std::size_t m = cluster.tracks.size();
  const Costs& costs = problem.costs();
  std::vector<double> best(m + 1), next(m + 1);  // Index m: no track.
  std::vector<std::size_t> back(path.size() * (m + 1));
  std::vector<char> taken(m);

  for (int round = 0; round < kRounds; ++round) {
    bool has_changed = false;
    for (std::size_t a = 0; a < cluster.truths.size(); ++a) {
      for (std::size_t t = 0; t < path.size(); ++t) {
        MarkTaken(path[t], a, taken);
        // From the cheapest state by a full switch, from none by half a one, or no change.
        std::size_t cheapest = m;
        for (std::size_t b = 0; b < m; ++b) {
          if (best[b] < best[cheapest]) cheapest = b;
        }
        for (std::size_t b = 0; b <= m; ++b) {
          double value = kForbidden;
          if (b == m || (!taken[b] && cluster.allowed[a * m + b])) {
            value = b < m ? GainOf(problem, cluster.truths[a], cluster.tracks[b], t) : 0.0;
            if (t > 0) {
              std::size_t from = b;
              double before = best[b];
              const double jump = b == m ? costs.full / 2.0 : costs.full;
              if (best[cheapest] + jump < before && cheapest != m) {
                from = cheapest;
                before = best[cheapest] + jump;
              }
              if (best[m] + costs.full / 2.0 < before && b != m) {
                from = m;
                before = best[m] + costs.full / 2.0;
              }
              value += before;
              back[t * (m + 1) + b] = from;
            }
          }
          next[b] = value;
        }
        best.swap(next);
      }
      auto state =
          static_cast<std::size_t>(std::min_element(best.begin(), best.end()) - best.begin());
      const double old_cost = CostOf(problem, cluster, path, a);
      if (!(best[state] < old_cost - 1e-9)) continue;
      has_changed = true;
      for (std::size_t t = path.size(); t-- > 0;) {
        path[t][a] = state == m ? -1 : static_cast<int>(state);
        state = back[t * (m + 1) + state];
      }
    }
    if (!has_changed) return;
  }
}

}  // namespace v2vouch::evaluation::tgospa
