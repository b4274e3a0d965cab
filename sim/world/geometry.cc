// SPDX-License-Identifier: Apache-2.0
#include "sim/world/geometry.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::sim {

std::array<Vec2, 4> Box::Corners() const {
  const double l = 0.5 * length_m;
  const double w = 0.5 * width_m;
  return {PointAt(l, w), PointAt(-l, w), PointAt(-l, -w), PointAt(l, -w)};
}

Vec2 Box::PointAt(double x_m, double y_m) const {
  const Vec2 forward = Direction(yaw_rad);
  return centre + x_m * forward + y_m * LeftOf(forward);
}

Vec2 Box::Local(const Vec2& point) const {
  const Vec2 forward = Direction(yaw_rad);
  const Vec2 d = point - centre;
  return {d.dot(forward), d.dot(LeftOf(forward))};
}

bool Box::Contains(const Vec2& point, double margin_m) const {
  const Vec2 local = Local(point);
  return std::abs(local.x()) <= 0.5 * length_m + margin_m &&
         std::abs(local.y()) <= 0.5 * width_m + margin_m;
}

bool Overlap(const Box& a, const Box& b) {
  const auto corners_a = a.Corners();
  const auto corners_b = b.Corners();
  for (const double yaw : {a.yaw_rad, a.yaw_rad + kPi / 2, b.yaw_rad, b.yaw_rad + kPi / 2}) {
    const Vec2 axis = Direction(yaw);
    const auto along = [&](const Vec2& p, const Vec2& q) { return p.dot(axis) < q.dot(axis); };
    const auto [a_low, a_high] = std::minmax_element(corners_a.begin(), corners_a.end(), along);
    const auto [b_low, b_high] = std::minmax_element(corners_b.begin(), corners_b.end(), along);
    if (a_high->dot(axis) < b_low->dot(axis) || b_high->dot(axis) < a_low->dot(axis)) return false;
  }
  return true;
}

std::optional<double> RayHitsSegment(const Vec2& origin, const Vec2& direction, const Vec2& a,
                                     const Vec2& b) {
  const Vec2 edge = b - a;
  const double denominator = Cross(direction, edge);
  if (std::abs(denominator) < 1e-12) return std::nullopt;
  const Vec2 to_a = a - origin;
  const double distance = Cross(to_a, edge) / denominator;
  const double share = Cross(to_a, direction) / denominator;
  if (distance < 0.0 || share < 0.0 || share > 1.0) return std::nullopt;
  return distance;
}

std::optional<double> RayHitsOutline(const Vec2& origin, const Vec2& direction,
                                     const std::vector<Vec2>& outline) {
  std::optional<double> nearest;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const auto hit =
        RayHitsSegment(origin, direction, outline[i], outline[(i + 1) % outline.size()]);
    if (hit && (!nearest || *hit < *nearest)) nearest = hit;
  }
  return nearest;
}

bool LineCrossesOutline(const Vec2& a, const Vec2& b, const std::vector<Vec2>& outline) {
  const double length = (b - a).norm();
  if (length <= 0.0) return false;
  const auto hit = RayHitsOutline(a, (b - a) / length, outline);
  return hit && *hit < length;
}

}  // namespace v2vouch::sim
