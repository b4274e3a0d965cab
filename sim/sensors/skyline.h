// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "sim/world/world.h"

namespace v2vouch::sim {

/// What stands in which direction from one point: rays at fixed azimuth steps, each with every
/// object it meets, nearest first. Vehicles and buildings are upright prisms on flat ground.
class Skyline {
 public:
  struct Hit {
    int object = 0;        ///< Index into Snapshot::actors; past them, buildings.
    double range_m = 0.0;  ///< Horizontal, to the object's nearest face on this ray.
    double height_m = 0.0;
  };

  /// @param half_span_rad rays cover +- this around `yaw_rad`, at most pi.
  Skyline(double half_span_rad, double step_rad);

  /// Casts all rays anew from `origin`. Objects beyond `max_range_m` are left out.
  void Cast(const Vec2& origin, double yaw_rad, double max_range_m, const Snapshot& snapshot,
            const std::vector<Wall>& walls);

  [[nodiscard]] int size() const { return static_cast<int>(rays_.size()); }
  [[nodiscard]] double azimuth_rad(int ray) const {
    return (ray + 0.5) * step_rad_ - half_span_rad_;
  }
  [[nodiscard]] const std::vector<Hit>& hits(int ray) const {
    return rays_[static_cast<std::size_t>(ray)];
  }
  /// Ray whose direction is nearest, or -1 outside the span.
  [[nodiscard]] int RayAt(double azimuth_rad) const;
  /// Range of the nearest object in that direction; infinity where there is none.
  [[nodiscard]] double FreeRange(double azimuth_rad) const;

 private:
  void AddOutline(const Vec2& origin, double yaw_rad, double max_range_m, int object,
                  double height_m, const Vec2* corners, std::size_t count);
  void AddFace(const Vec2& left, const Vec2& right, double max_range_m, int object,
               double height_m);

  double half_span_rad_;
  double step_rad_;
  std::vector<Vec2> directions_;  ///< Of the rays, sensor axes.
  std::vector<std::vector<Hit>> rays_;
};

}  // namespace v2vouch::sim
