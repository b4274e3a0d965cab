// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>

#include "daemon/common/data/ego.h"
#include "daemon/local/tracking/track_table.h"

namespace v2vouch {

/// Which way vehicles drive where, learnt from those that were seen driving and from the ego
/// itself: what stands beside a lane most likely faces as that lane is driven. Silhouettes and
/// reflections of a stationary vehicle tell its axis, but not which end is its front.
///
/// A ring of the last `kMost` points of such ways, each with its direction, axes of O. Copyable,
/// fixed size: part of every checkpoint.
class RoadDirections {
 public:
  static constexpr std::size_t kMost = 160;

  /// After a frame: the ways of the ego and of the listed vehicles that were measured in motion.
  void Learn(const EgoState& ego, const TrackTable& table);
  /// Turns the front of each vehicle that was measured now, and was never seen driving, to where
  /// the way beside it leads.
  void FaceAlong(TrackTable& table) const;

  /// Something drives along `yaw_rad` at `p_O`. A point near one with much the same direction adds
  /// nothing.
  void Note(const Eigen::Vector2d& p_O, double yaw_rad);

  /// Direction of the way that passes nearest beside `p_O`, of those along `axis_rad` or against
  /// it. nullopt: none within a lane and a half.
  [[nodiscard]] std::optional<double> DirectionAt(const Eigen::Vector2d& p_O,
                                                  double axis_rad) const;

 private:
  struct Point {
    Eigen::Vector2d p_O = Eigen::Vector2d::Zero();
    Eigen::Vector2d forward = Eigen::Vector2d::UnitX();
    double yaw_rad = 0.0;
  };
  std::array<Point, kMost> points_;
  std::size_t count_ = 0;
  std::size_t last_ = 0;
};

}  // namespace v2vouch
