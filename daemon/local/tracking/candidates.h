// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

#include "daemon/local/tracking/place_index.h"

namespace v2vouch {

/// Standard deviations of the coarse gate; the chi-square gate decides.
inline constexpr double kCoarseSigmas = 4.7;
/// A vehicle reaches this share of its length from its centre, and a little more.
inline constexpr double kLengthReach = 0.7;

/// Standard deviation along the longest axis of a covariance ellipse.
inline double LargestSigma(const Eigen::Matrix2d& P) {
  const double mean = 0.5 * (P(0, 0) + P(1, 1));
  const double half = 0.5 * (P(0, 0) - P(1, 1));
  return std::sqrt(std::max(mean + std::sqrt(half * half + P(0, 1) * P(0, 1)), 0.0));
}

/// How far from its centre a vehicle may be measured, for the coarse gate [m].
inline double CoarseReach(const Eigen::Matrix2d& position_covariance, double length_m) {
  return kCoarseSigmas * LargestSigma(position_covariance) + kLengthReach * length_m;
}

/// What association knows about one measurement before it meets a track.
struct Candidate {
  Eigen::Vector2d p_O = Eigen::Vector2d::Zero();
  double reach_m = 0.0;          ///< Coarse gate of the measurement alone.
  double log_density = 0.0;      ///< ln of clutter and births per unit of the measurement's space.
  double birth_existence = 0.0;  ///< Of a track it would start.
  bool is_echo = false;          ///< May be the second echo of a vehicle at half the range.
  bool may_start = false;        ///< May start a track; a box that may not meets none either.

  /// Farther away than any track.
  static Eigen::Vector2d Nowhere() {
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::max() / 4.0);
  }
};

/// The candidates of one frame, searchable by position: a track is compared with near ones only.
class Candidates {
 public:
  void Clear() { all_.clear(); }
  void Add(const Candidate& candidate) { all_.push_back(candidate); }
  [[nodiscard]] std::size_t size() const { return all_.size(); }
  Candidate& operator[](std::size_t j) { return all_[j]; }
  const Candidate& operator[](std::size_t j) const { return all_[j]; }

  /// To be called after the last Add, before ForEachNear.
  void Sort() {
    widest_m_ = 0.0;
    places_.Clear();
    for (std::size_t j = 0; j < all_.size(); ++j) {
      places_.Add(all_[j].p_O, j);
      widest_m_ = std::max(widest_m_, all_[j].reach_m);
    }
    places_.Sort();
  }

  /// Of more than `most` candidates those that come last by key(j) may start nothing.
  /// @return whether any had to be denied.
  template <class Key>
  bool KeepFirst(std::size_t most, Key&& key) {
    if (all_.size() <= most) return false;
    order_.resize(all_.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::sort(order_, {}, key);
    for (std::size_t k = most; k < order_.size(); ++k) all_[order_[k]].may_start = false;
    return true;
  }

  /// Calls visit(j) for every candidate whose own reach and `reach_m` together bridge the distance
  /// to `p_O`.
  template <class Visitor>
  void ForEachNear(const Eigen::Vector2d& p_O, double reach_m, Visitor&& visit) const {
    places_.ForEachNear(p_O, reach_m + widest_m_, [&](std::size_t j) {
      const double reach = reach_m + all_[j].reach_m;
      if ((all_[j].p_O - p_O).squaredNorm() <= reach * reach) visit(j);
    });
  }

 private:
  std::vector<Candidate> all_;
  std::vector<std::size_t> order_;
  PlaceIndex places_;
  double widest_m_ = 0.0;
};

}  // namespace v2vouch
