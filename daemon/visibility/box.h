// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "daemon/visibility/visibility.h"

namespace v2vouch {

/// p_O in the box's own axes, from its centre.
inline Eigen::Vector2d InBox(const Occluder& box, const Eigen::Vector2d& p_O) {
  const double c = std::cos(box.yaw_rad);
  const double s = std::sin(box.yaw_rad);
  const Eigen::Vector2d d = p_O - box.centre_O;
  return {c * d.x() + s * d.y(), -s * d.x() + c * d.y()};
}

/// Whether the box, grown by `margin_m` on all sides, holds the point.
inline bool Holds(const Occluder& box, const Eigen::Vector2d& p_O, double margin_m) {
  const double reach_m = 0.5 * (box.length_m + box.width_m) + 2.0 * margin_m;
  if ((p_O - box.centre_O).squaredNorm() > reach_m * reach_m) return false;
  const Eigen::Vector2d q = InBox(box, p_O);
  return std::abs(q.x()) <= 0.5 * box.length_m + margin_m &&
         std::abs(q.y()) <= 0.5 * box.width_m + margin_m;
}

/// A box as seen from a point outside it. Edges are angles from the line of sight to `towards`,
/// left positive; ranges from the point.
struct Silhouette {
  Silhouette() = default;
  Silhouette(const Occluder& seen, const Eigen::Vector2d& from, const Eigen::Vector2d& towards)
      : box(seen), from_box(InBox(seen, from)) {
    const Eigen::Vector2d sight = towards - from;
    bearing_O = std::atan2(sight.y(), sight.x());
    ray = sight.normalized();
    centre_m = (seen.centre_O - from).norm();
    c = std::cos(seen.yaw_rad);
    s = std::sin(seen.yaw_rad);
    const Eigen::Vector2d half(0.5 * seen.length_m, 0.5 * seen.width_m);
    nearest_m = (from_box.cwiseAbs() - half).cwiseMax(0.0).norm();
    right_rad = std::numeric_limits<double>::infinity();
    left_rad = -right_rad;
    farthest_m = 0.0;
    for (const double along : {-half.x(), half.x()}) {
      for (const double across : {-half.y(), half.y()}) {
        const Eigen::Vector2d d =
            seen.centre_O - from + Eigen::Vector2d(c * along - s * across, s * along + c * across);
        const double angle = std::atan2(ray.x() * d.y() - ray.y() * d.x(), ray.dot(d));
        right_rad = std::min(right_rad, angle);
        left_rad = std::max(left_rad, angle);
        farthest_m = std::max(farthest_m, d.norm());
      }
    }
  }

  /// Where a ray (unit vector in O) enters the box; nullopt where it misses.
  [[nodiscard]] std::optional<double> EntryAlong(const Eigen::Vector2d& ray_O) const {
    const double dx = c * ray_O.x() + s * ray_O.y();
    const double dy = -s * ray_O.x() + c * ray_O.y();
    double entry = 0.0;
    double exit = std::numeric_limits<double>::infinity();
    const auto clip = [&](double start, double step, double half) {
      if (std::abs(step) < 1e-12) {
        if (std::abs(start) > half) exit = -1.0;
        return;
      }
      const double a = (-half - start) / step;
      const double b = (half - start) / step;
      entry = std::max(entry, std::min(a, b));
      exit = std::min(exit, std::max(a, b));
    };
    clip(from_box.x(), dx, 0.5 * box.length_m);
    clip(from_box.y(), dy, 0.5 * box.width_m);
    if (entry > exit) return std::nullopt;
    return entry;
  }

  Occluder box;
  Eigen::Vector2d from_box = Eigen::Vector2d::Zero();  ///< The point in the box's axes.
  Eigen::Vector2d ray = Eigen::Vector2d::UnitX();      ///< Line of sight, unit vector in O.
  double bearing_O = 0.0;                              ///< Of the line of sight.
  double c = 1.0;                                      ///< Of the box's yaw, as s.
  double s = 0.0;
  double right_rad = 0.0;
  double left_rad = 0.0;
  double nearest_m = 0.0;
  double centre_m = 0.0;
  double farthest_m = 0.0;
};

}  // namespace v2vouch
