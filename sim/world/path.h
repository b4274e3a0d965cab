// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/world/geometry.h"

namespace v2vouch::sim {

/// A corner of a route and how tightly it is driven.
struct Waypoint {
  Vec2 position = Vec2::Zero();
  double radius_m = 10.0;  ///< Smallest radius of the curve that cuts this corner.
};

/// Point of a path: place, direction, curvature (left positive).
struct PathPoint {
  Vec2 position = Vec2::Zero();
  double yaw_rad = 0.0;  ///< Continuous along the path, not wrapped.
  double curvature_per_m = 0.0;
};

/// A drivable line through waypoints: straights joined by curves whose curvature rises and falls
/// as half a cosine wave over 35 % of the curve at either end, so steering never jumps.
/// Beyond its ends it runs on straight. Arc length counts from the first waypoint.
class Path {
 public:
  /// @return false with `problem` set when there are fewer than two distinct waypoints, a corner
  /// turns by more than 170 degrees, or neighbouring curves do not fit between their waypoints.
  static bool Make(const std::vector<Waypoint>& waypoints, Path& path, std::string& problem);

  [[nodiscard]] PathPoint At(double s_m) const;
  [[nodiscard]] double length_m() const { return length_m_; }

 private:
  static constexpr double kStep_m = 0.05;
  std::vector<PathPoint> points_;  // Every kStep_m.
  double length_m_ = 0.0;
};

}  // namespace v2vouch::sim
