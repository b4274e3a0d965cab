// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/skyline.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::sim {

Skyline::Skyline(double half_span_rad, double step_rad)
    : half_span_rad_(half_span_rad), step_rad_(step_rad) {
  rays_.resize(static_cast<std::size_t>(std::ceil(2.0 * half_span_rad / step_rad)));
  for (int ray = 0; ray < size(); ++ray) directions_.push_back(Direction(azimuth_rad(ray)));
}

int Skyline::RayAt(double azimuth_rad) const {
  const double exact = (azimuth_rad + half_span_rad_) / step_rad_;
  if (!(exact >= 0.0) || exact >= static_cast<double>(rays_.size())) return -1;
  return static_cast<int>(exact);
}

double Skyline::FreeRange(double azimuth_rad) const {
  const int ray = RayAt(azimuth_rad);
  if (ray < 0 || hits(ray).empty()) return std::numeric_limits<double>::infinity();
  return hits(ray).front().range_m;
}

void Skyline::AddFace(const Vec2& left, const Vec2& right, double max_range_m, int object,
                      double height_m) {
  const Vec2 edge = left - right;
  const double cross = Cross(right, edge);  // Twice the area with us at the tip; above 0 here.
  const double from_rad = std::atan2(right.y(), right.x());
  const double span = AngleDifference(std::atan2(left.y(), left.x()), from_rad);
  for (const double low : {from_rad, from_rad - 2.0 * kPi}) {  // A face may straddle the back.
    const double first = std::ceil((low + half_span_rad_) / step_rad_ - 0.5);
    const double last = std::floor((low + span + half_span_rad_) / step_rad_ - 0.5);
    const int from = static_cast<int>(std::max(0.0, first));
    const int to = static_cast<int>(std::min(last, static_cast<double>(size() - 1)));
    for (int ray = from; ray <= to; ++ray) {
      const auto index = static_cast<std::size_t>(ray);
      const double across = Cross(directions_[index], edge);
      if (across <= 1e-12) continue;  // Along the face, but for rounding.
      const double range = cross / across;
      if (range > max_range_m) continue;
      std::vector<Hit>& hits = rays_[index];
      if (!hits.empty() && hits.back().object == object) {
        hits.back().range_m = std::min(hits.back().range_m, range);
      } else {
        hits.push_back({object, range, height_m});
      }
    }
  }
}

void Skyline::AddOutline(const Vec2& origin, double yaw_rad, double max_range_m, int object,
                         double height_m, const Vec2* corners, std::size_t count) {
  const Vec2 forward = Direction(yaw_rad);
  const Vec2 left = LeftOf(forward);
  const auto in_sensor_axes = [&](const Vec2& point) -> Vec2 {
    const Vec2 d = point - origin;
    return {d.dot(forward), d.dot(left)};
  };
  Vec2 a = in_sensor_axes(corners[0]);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 b = in_sensor_axes(corners[(i + 1) % count]);
    // Counter-clockwise outline: a face that looks at us runs clockwise round us.
    if (Cross(a, b) < 0.0) AddFace(a, b, max_range_m, object, height_m);
    a = b;
  }
}

void Skyline::Cast(const Vec2& origin, double yaw_rad, double max_range_m, const Snapshot& snapshot,
                   const std::vector<Wall>& walls) {
  for (auto& ray : rays_) ray.clear();
  int object = 0;
  for (const ActorState& actor : snapshot.actors) {
    const double reach = max_range_m + 0.5 * actor.actor->size.length_m;
    if ((actor.motion.centre - origin).squaredNorm() < reach * reach) {
      const auto corners = actor.box().Corners();
      AddOutline(origin, yaw_rad, max_range_m, object, actor.actor->size.height_m, corners.data(),
                 corners.size());
    }
    ++object;
  }
  for (const Wall& wall : walls) {
    AddOutline(origin, yaw_rad, max_range_m, object++, wall.height_m, wall.outline.data(),
               wall.outline.size());
  }
  for (auto& ray : rays_) {
    std::stable_sort(ray.begin(), ray.end(),
                     [](const Hit& a, const Hit& b) { return a.range_m < b.range_m; });
  }
}

}  // namespace v2vouch::sim
