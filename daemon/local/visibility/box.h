// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace v2vouch {

/// An oriented box in O that may hide what is behind it.
struct Occluder {
  std::uint64_t id = 0;  ///< Track it belongs to; a track never hides itself. 0: none.
  Eigen::Vector2d centre_O = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double length_m = 4.5;
  double width_m = 1.8;
  double position_sigma_m = 0.3;
};

/// An occluder with its axes worked out: every question asks for them.
struct Box : Occluder {
  explicit Box(const Occluder& occluder)
      : Occluder(occluder), c(std::cos(occluder.yaw_rad)), s(std::sin(occluder.yaw_rad)) {}

  double c;  ///< Cosine of its yaw, as s its sine.
  double s;
};

/// p_O in the box's own axes, from its centre.
inline Eigen::Vector2d InBox(const Box& box, const Eigen::Vector2d& p_O) {
  const Eigen::Vector2d d = p_O - box.centre_O;
  return {box.c * d.x() + box.s * d.y(), -box.s * d.x() + box.c * d.y()};
}

/// Whether the box, grown by `margin_m` on all sides, holds the point.
inline bool Holds(const Box& box, const Eigen::Vector2d& p_O, double margin_m) {
  const double reach_m = 0.5 * (box.length_m + box.width_m) + 2.0 * margin_m;
  if ((p_O - box.centre_O).squaredNorm() > reach_m * reach_m) return false;
  const Eigen::Vector2d q = InBox(box, p_O);
  return std::abs(q.x()) <= 0.5 * box.length_m + margin_m &&
         std::abs(q.y()) <= 0.5 * box.width_m + margin_m;
}

/// A box as seen from a point outside it. Edges are angles from a line of sight, left positive;
/// ranges count from the point. Left uninitialised until Look() fills it: queries keep an array.
struct Silhouette {
  /// @param sight unit vector of the line of sight, in O.
  void Look(const Box& seen, const Eigen::Vector2d& from, const Eigen::Vector2d& sight) {
    const Eigen::Vector2d d = seen.centre_O - from;
    c = seen.c;
    s = seen.s;
    half = {0.5 * seen.length_m, 0.5 * seen.width_m};
    from_box = {-c * d.x() - s * d.y(), s * d.x() - c * d.y()};
    sigma_m = seen.position_sigma_m;
    centre_m = d.norm();
    nearest_m = (from_box.cwiseAbs() - half).cwiseMax(0.0).norm();
    right_rad = std::numeric_limits<double>::infinity();
    left_rad = -right_rad;
    // Only the outermost corners' angles are asked for. Ahead, the tangent tells which they are;
    // corners that rounding might swap are all asked.
    struct Corner {
      double aside;
      double ahead;
      double tangent;
    };
    std::array<Corner, 4> corners;
    std::size_t count = 0;
    double lowest = right_rad;
    double highest = left_rad;
    bool is_ahead = true;
    for (const double along : {-half.x(), half.x()}) {
      for (const double across : {-half.y(), half.y()}) {
        const Eigen::Vector2d corner =
            d + Eigen::Vector2d(c * along - s * across, s * along + c * across);
        Corner& seen_at = corners[count++];
        seen_at.aside = sight.x() * corner.y() - sight.y() * corner.x();
        seen_at.ahead = sight.dot(corner);
        seen_at.tangent = seen_at.aside / seen_at.ahead;
        is_ahead = is_ahead && seen_at.ahead > 0.0;
        lowest = std::min(lowest, seen_at.tangent);
        highest = std::max(highest, seen_at.tangent);
      }
    }
    const double low_tie = lowest + 1e-9 * (1.0 + std::abs(lowest));
    const double high_tie = highest - 1e-9 * (1.0 + std::abs(highest));
    for (const Corner& corner : corners) {
      if (is_ahead && corner.tangent > low_tie && corner.tangent < high_tie) continue;
      const double angle = std::atan2(corner.aside, corner.ahead);
      right_rad = std::min(right_rad, angle);
      left_rad = std::max(left_rad, angle);
    }
  }

  /// Where a ray (unit vector in O) enters the box; `otherwise` where it misses.
  [[nodiscard]] double EntryAlong(const Eigen::Vector2d& ray_O, double otherwise) const {
    const double dx = c * ray_O.x() + s * ray_O.y();
    const double dy = -s * ray_O.x() + c * ray_O.y();
    double entry = 0.0;
    double exit = std::numeric_limits<double>::infinity();
    const auto clip = [&](double start, double step, double half_size) {
      if (std::abs(step) < 1e-12) {
        if (std::abs(start) > half_size) exit = -1.0;
        return;
      }
      const double a = (-half_size - start) / step;
      const double b = (half_size - start) / step;
      entry = std::max(entry, std::min(a, b));
      exit = std::min(exit, std::max(a, b));
    };
    clip(from_box.x(), dx, half.x());
    clip(from_box.y(), dy, half.y());
    return entry > exit ? otherwise : entry;
  }

  Eigen::Vector2d from_box;  ///< The point in the box's axes.
  Eigen::Vector2d half;      ///< Half length and width.
  double c;                  ///< Of the box's yaw, as s.
  double s;
  double sigma_m;
  double right_rad;
  double left_rad;
  double nearest_m;
  double centre_m;
};

}  // namespace v2vouch
