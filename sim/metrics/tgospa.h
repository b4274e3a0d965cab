// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

namespace v2vouch::evaluation {

/// One truth or track over the steps of a run; NaN where it does not exist.
using Trajectory = std::vector<Eigen::Vector2d>;

inline Eigen::Vector2d Absent() {
  return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
}

enum class BaseDistance {
  kEuclidean,  ///< Metres, whatever p.
  kOrderNorm,  ///< The p-norm, as the reference codes have it (L1 at p = 1).
};

struct TrajectoryGospaParameters {
  double cutoff_m = 10.0;  ///< c.
  double order = 2.0;      ///< p.
  double switch_m = 5.0;   ///< gamma: a full switch costs gamma^p, to or from nothing gamma^p / 2.
  BaseDistance base = BaseDistance::kEuclidean;
  std::size_t exact_states = 512;  ///< Clusters with more matchings than this use the beam.
  std::size_t beam = 48;           ///< States kept per step there.
};

struct TrajectoryGospaResult {
  double tgospa = 0.0;  ///< power^(1/p), over all steps.
  double power = 0.0;
  double localisation_pow = 0.0;
  double missed_pow = 0.0;
  double false_pow = 0.0;
  double switch_pow = 0.0;
  bool is_exact = true;  ///< False: at least one cluster used the beam; `power` is an upper bound.
};

/// GOSPA of whole trajectories: per-step matchings whose changes cost.
///
///     min over matchings pi_1..pi_T of  sum_t [ sum_pairs d^p + c^p/2 (missed + false) ]
///                                     + sum_t sum_truths s(pi_t(i), pi_t+1(i))
///
/// s = 0 for no change, gamma^p from track to track, gamma^p/2 to or from none. A pair kept while
/// one of the two is absent costs c^p/2 for the one present; beyond c it costs c^p.
///
/// Method: truths and tracks that never come closer than c never share a pair, so the problem
/// splits into clusters. In a cluster of at most `exact_states` matchings, dynamic programming
/// (Viterbi) over all of them is exact. In a larger one, a beam: every kept state's best successor
/// (an assignment problem whose costs include the switches), its unchanged successor, and the
/// step's own optimum; the cheapest `beam` of these go on; then each truth's sequence in turn is
/// improved over the whole run with the others fixed. Upper bound, marked.
/// Source: Garcia-Fernandez, Rahmathullah, Svensson, "A metric on the space of finite sets of
/// trajectories", IEEE TSP 2020; the integer form, which equals the linear programme's value on
/// every published vector.
/// All trajectories must have the same number of steps.
TrajectoryGospaResult TrajectoryGospa(const std::vector<Trajectory>& truths,
                                      const std::vector<Trajectory>& tracks,
                                      const TrajectoryGospaParameters& parameters);

}  // namespace v2vouch::evaluation
