// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "daemon/common/assignment/assignment.h"

namespace v2vouch::evaluation {

struct GospaParameters {
  double cutoff_m = 10.0;  ///< c: a pair this far apart is one missed and one false.
  double order = 2.0;      ///< p >= 1.
  double alpha = 2.0;      ///< In (0, 2]. Only alpha = 2 splits into missed and false.
};

/// One instant's GOSPA. `_pow` fields are p-th powers and add up; the roots are what MATLAB's
/// trackGOSPAMetric calls "error" and what the paper's table shows.
struct GospaResult {
  double gospa = 0.0;             ///< Power^(1/p).
  double power = 0.0;             ///< gospa^p.
  double localisation_pow = 0.0;  ///< Over pairs closer than c.
  double missed_pow = 0.0;        ///< num_missed c^p / 2; 0 unless alpha = 2.
  double false_pow = 0.0;         ///< num_false c^p / 2; 0 unless alpha = 2.
  int num_assigned = 0;
  int num_missed = 0;
  int num_false = 0;
  std::vector<int> assignment;  ///< Per truth its track's index, or -1.
};

/// `power` back to a length: power^(1/p).
double Root(double power, double order);

/// Generalised optimal sub-pattern assignment distance between truths X and tracks Y.
///
///     d = ( min over matchings of  sum min(d_ij, c)^p  +  c^p/alpha | |X| - |Y| | )^(1/p)
///
/// where the smaller set is matched completely; with alpha = 2 this is
///
///     d^p = sum over pairs with d_ij < c of d_ij^p  +  c^p/2 (missed + false).
///
/// A pair at d_ij >= c counts as one missed and one false. Not divided by the number of objects.
/// Source: Rahmathullah, Garcia-Fernandez, Svensson, "Generalized optimal sub-pattern assignment
/// metric", FUSION 2017, definition 1 and proposition 1.
class Gospa {
 public:
  explicit Gospa(const GospaParameters& parameters);

  /// @param distance row-major truths x tracks, base distances >= 0 (metres).
  const GospaResult& FromDistances(std::span<const double> distance, std::size_t truths,
                                   std::size_t tracks);
  /// Euclidean base distance between points of one frame.
  const GospaResult& FromPoints(std::span<const Eigen::Vector2d> truths,
                                std::span<const Eigen::Vector2d> tracks);

 private:
  GospaParameters parameters_;
  AssignmentSolver solver_;
  GospaResult result_;
  std::vector<double> distance_, cost_, lone_;
};

/// Counts how truths change their track from one instant to the next. A truth that goes from one
/// track to another counts 1; from a track to none or back counts 1/2; its first track ever counts
/// 0. A truth that is absent at an instant starts afresh at the next, except that its first track
/// has been had. The penalty of an instant is SP n^(1/p), of power SP^p n.
/// Source: MathWorks trackGOSPAMetric as implemented by Stone Soup.
class SwitchCounter {
 public:
  static constexpr std::int64_t kNoTrack = INT64_MIN;
  struct Held {
    std::int64_t truth = 0;
    std::int64_t track = kNoTrack;
  };
  /// @return n of this instant.
  double Step(std::span<const Held> now);

 private:
  struct Memory {
    std::int64_t track = kNoTrack;
    bool ever_held = false;
    std::int64_t step = -1;
  };
  std::map<std::int64_t, Memory> memory_;
  std::int64_t step_ = 0;
};

}  // namespace v2vouch::evaluation
