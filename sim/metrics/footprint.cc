// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/footprint.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace v2vouch::evaluation {
namespace {

using Vec2 = Eigen::Vector2d;

double Cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

bool SegmentsMeet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double c_side = Cross(b - a, c - a), d_side = Cross(b - a, d - a);
  const double a_side = Cross(d - c, a - c), b_side = Cross(d - c, b - c);
  return c_side * d_side <= 0.0 && a_side * b_side <= 0.0 &&
         (c_side != d_side || a_side != b_side);  // Parallel lines meet nowhere that matters.
}

bool MeetsEdges(const Vec2& a, const Vec2& b, std::span<const Vec2> outline) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (SegmentsMeet(a, b, outline[i], outline[(i + 1) % outline.size()])) return true;
  }
  return false;
}

double Area(const std::vector<Vec2>& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    twice += Cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  }
  return 0.5 * twice;
}

// The part of `polygon` to the left of the line from a to b (Sutherland and Hodgman, 1974).
std::vector<Vec2> ClippedLeft(const std::vector<Vec2>& polygon, const Vec2& a, const Vec2& b) {
  std::vector<Vec2> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& from = polygon[i];
    const Vec2& to = polygon[(i + 1) % polygon.size()];
    const double from_side = Cross(b - a, from - a), to_side = Cross(b - a, to - a);
    if (from_side >= 0.0) kept.push_back(from);
    if ((from_side > 0.0 && to_side < 0.0) || (from_side < 0.0 && to_side > 0.0)) {
      kept.push_back(from + (to - from) * (from_side / (from_side - to_side)));
    }
  }
  return kept;
}

}  // namespace

std::array<Vec2, 4> Footprint::Corners() const {
  const Vec2 along = 0.5 * length_m * Vec2(std::cos(yaw_rad), std::sin(yaw_rad));
  const Vec2 left = 0.5 * width_m * Vec2(-std::sin(yaw_rad), std::cos(yaw_rad));
  return {centre + along + left, centre - along + left, centre - along - left,
          centre + along - left};
}

double Footprint::DistanceTo(const Vec2& point) const {
  const Vec2 line = point - centre;
  const Vec2 along(std::cos(yaw_rad), std::sin(yaw_rad));
  const double ahead = std::max(0.0, std::abs(along.dot(line)) - 0.5 * length_m);
  const double aside = std::max(0.0, std::abs(Cross(along, line)) - 0.5 * width_m);
  return std::hypot(ahead, aside);
}

bool LineMeets(const Vec2& a, const Vec2& b, const std::vector<Vec2>& outline) {
  return MeetsEdges(a, b, outline);
}

bool LineMeets(const Vec2& a, const Vec2& b, const Footprint& box) {
  return MeetsEdges(a, b, box.Corners());
}

double OverlapShare(const Footprint& a, const Footprint& b) {
  const double smaller = std::min(a.length_m * a.width_m, b.length_m * b.width_m);
  if (!(smaller > 0.0)) return 0.0;
  const double reach =
      0.5 * (std::hypot(a.length_m, a.width_m) + std::hypot(b.length_m, b.width_m));
  if ((a.centre - b.centre).norm() >= reach) return 0.0;
  const auto corners = a.Corners();
  std::vector<Vec2> shared(corners.begin(), corners.end());
  const auto edge = b.Corners();
  for (std::size_t i = 0; i < edge.size() && !shared.empty(); ++i) {
    shared = ClippedLeft(shared, edge[i], edge[(i + 1) % edge.size()]);
  }
  return std::clamp(Area(shared) / smaller, 0.0, 1.0);
}

}  // namespace v2vouch::evaluation
