// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "daemon/common/base/angle.h"

namespace v2vouch::sim {

using Vec2 = Eigen::Vector2d;

/// Unit vector in direction `yaw_rad`, counter-clockwise from east.
inline Vec2 Direction(double yaw_rad) { return {std::cos(yaw_rad), std::sin(yaw_rad)}; }

/// `v` turned a quarter to the left.
inline Vec2 LeftOf(const Vec2& v) { return {-v.y(), v.x()}; }

inline double Cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Footprint of a vehicle in the world frame W [m, rad].
struct Box {
  Vec2 centre = Vec2::Zero();
  double yaw_rad = 0.0;
  double length_m = 4.5;
  double width_m = 1.8;

  /// Front left, rear left, rear right, front right: counter-clockwise seen from above.
  [[nodiscard]] std::array<Vec2, 4> Corners() const;
  /// A point given along the vehicle's axes, x forward, y left, from the centre.
  [[nodiscard]] Vec2 PointAt(double x_m, double y_m) const;
  /// `point` along the vehicle's axes, from the centre.
  [[nodiscard]] Vec2 Local(const Vec2& point) const;
  /// `margin_m` is added on every side.
  [[nodiscard]] bool Contains(const Vec2& point, double margin_m = 0.0) const;
};

/// Whether two footprints touch (separating axes).
bool Overlap(const Box& a, const Box& b);

/// Distance along the ray from `origin` in unit direction `direction` to the segment a-b.
/// @return nullopt when it is missed, lies behind, or runs parallel.
std::optional<double> RayHitsSegment(const Vec2& origin, const Vec2& direction, const Vec2& a,
                                     const Vec2& b);

/// Nearest hit of a closed outline, same conventions.
std::optional<double> RayHitsOutline(const Vec2& origin, const Vec2& direction,
                                     const std::vector<Vec2>& outline);

/// Whether the straight line from a to b crosses the outline.
bool LineCrossesOutline(const Vec2& a, const Vec2& b, const std::vector<Vec2>& outline);

}  // namespace v2vouch::sim
