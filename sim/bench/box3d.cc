// SPDX-License-Identifier: Apache-2.0
#include "sim/bench/box3d.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <vector>

namespace v2vouch::bench {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;

// Corners counter-clockwise.
Polygon Footprint(const Box3d& box) {
  const Eigen::Rotation2D<double> R(box.yaw_rad);
  const double l = 0.5 * box.length_m;
  const double w = 0.5 * box.width_m;
  Polygon corners;
  for (const auto& [x, y] : {std::pair{l, -w}, {l, w}, {-l, w}, {-l, -w}}) {
    corners.push_back(Eigen::Vector2d(box.x_m, box.y_m) + R * Eigen::Vector2d(x, y));
  }
  return corners;
}

double Area(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

// Sutherland and Hodgman (1974): `polygon` cut by each edge of a convex counter-clockwise one.
Polygon Clip(Polygon polygon, const Polygon& by) {
  for (std::size_t i = 0; i < by.size() && polygon.size() >= 3; ++i) {
    const Eigen::Vector2d& a = by[i];
    const Eigen::Vector2d edge = by[(i + 1) % by.size()] - a;
    const auto left_of = [&](const Eigen::Vector2d& p) {
      return edge.x() * (p.y() - a.y()) - edge.y() * (p.x() - a.x());
    };
    Polygon kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Eigen::Vector2d& u = polygon[(k + polygon.size() - 1) % polygon.size()];
      const Eigen::Vector2d& v = polygon[k];
      const double side_u = left_of(u);
      const double side_v = left_of(v);
      if ((side_u >= 0.0) != (side_v >= 0.0)) {
        kept.emplace_back(u + side_u / (side_u - side_v) * (v - u));
      }
      if (side_v >= 0.0) kept.push_back(v);
    }
    polygon = std::move(kept);
  }
  return polygon;
}

}  // namespace

double Iou3d(const Box3d& a, const Box3d& b) {
  const double reach =
      0.5 * (std::hypot(a.length_m, a.width_m) + std::hypot(b.length_m, b.width_m));
  if (std::hypot(a.x_m - b.x_m, a.y_m - b.y_m) > reach) return 0.0;
  const double high =
      std::min(a.bottom_m + a.height_m, b.bottom_m + b.height_m) - std::max(a.bottom_m, b.bottom_m);
  if (!(high > 0.0)) return 0.0;
  const Polygon both = Clip(Footprint(a), Footprint(b));
  if (both.size() < 3) return 0.0;
  const double volume = std::abs(Area(both)) * high;
  const double either = a.length_m * a.width_m * a.height_m + b.length_m * b.width_m * b.height_m;
  return volume / (either - volume);
}

double CoveredShare(const PixelBox& box, const PixelBox& region) {
  if (!(box.area() > 0.0)) return 0.0;
  const double wide = std::min(box.right, region.right) - std::max(box.left, region.left);
  const double high = std::min(box.bottom, region.bottom) - std::max(box.top, region.top);
  return std::max(wide, 0.0) * std::max(high, 0.0) / box.area();
}

}  // namespace v2vouch::bench
