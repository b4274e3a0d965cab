// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "daemon/local/tracking/place_index.h"

namespace v2vouch {

/// Standard deviation along the longest axis of a covariance ellipse.
inline double LargestSigma(const Eigen::Matrix2d& P) {
  const double mean = 0.5 * (P(0, 0) + P(1, 1));
  const double half = 0.5 * (P(0, 0) - P(1, 1));
  return std::sqrt(std::max(mean + std::sqrt(half * half + P(0, 1) * P(0, 1)), 0.0));
}

/// What association knows about one measurement before it meets a track.
struct Candidate {
  Eigen::Vector2d p_O = Eigen::Vector2d::Zero();
  double reach_m = 0.0;          ///< Coarse gate of the measurement alone.
  double log_density = 0.0;      ///< ln of clutter and births per unit of the measurement's space.
  double birth_existence = 0.0;  ///< Of a track it would start.
  bool is_echo = false;          ///< May be the second echo of a vehicle at half the range.
  bool may_start = false;
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
  PlaceIndex places_;
  double widest_m_ = 0.0;
};

}  // namespace v2vouch
