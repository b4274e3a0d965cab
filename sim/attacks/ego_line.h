// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/world/world.h"

namespace v2vouch::sim {

/// The line that the centre of the ego's footprint follows during the run, straight beyond its
/// ends.
class EgoLine {
 public:
  explicit EgoLine(const World& world);

  /// How far the ego has come by then [m].
  [[nodiscard]] double DistanceAt(double time_s) const;

  struct Point {
    Vec2 position = Vec2::Zero();
    double yaw_rad = 0.0;
  };
  [[nodiscard]] Point At(double distance_m) const;

 private:
  static constexpr double kStep_s = 0.05;
  std::vector<double> by_time_;   ///< Distance every kStep_s.
  std::vector<double> distance_;  ///< Of `points_`, rising.
  std::vector<Point> points_;
};

}  // namespace v2vouch::sim
