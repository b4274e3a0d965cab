// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace v2vouch::evaluation {

/// A vehicle's box on the ground, world frame W [m, rad].
struct Footprint {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double length_m = 0.0;
  double width_m = 0.0;

  /// Front left, rear left, rear right, front right: counter-clockwise seen from above.
  [[nodiscard]] std::array<Eigen::Vector2d, 4> Corners() const;
  /// From `point` to the nearest point of the box; 0 inside.
  [[nodiscard]] double DistanceTo(const Eigen::Vector2d& point) const;
};

/// Whether the straight line from a to b meets a closed outline's edges.
bool LineMeets(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
               const std::vector<Eigen::Vector2d>& outline);
bool LineMeets(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Footprint& box);

/// Area that two boxes share, over the area of the smaller one: 0..1. 0 where a box has no area.
double OverlapShare(const Footprint& a, const Footprint& b);

}  // namespace v2vouch::evaluation
