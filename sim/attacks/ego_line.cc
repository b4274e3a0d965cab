// SPDX-License-Identifier: Apache-2.0
#include "sim/attacks/ego_line.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::sim {

EgoLine::EgoLine(const World& world) {
  constexpr double kShortest_m = 0.01;  // Closer points give no direction.
  const double centre_m = world.scenario().vehicle.centre_x_m;
  const auto steps = static_cast<std::size_t>(world.scenario().duration_s / kStep_s) + 2;
  for (std::size_t k = 0; k < steps; ++k) {
    const EgoTruth ego = world.At(static_cast<double>(k) * kStep_s).ego;
    const Point point{ego.PointAt(centre_m, 0.0), ego.yaw_rad};
    const double moved = points_.empty() ? 0.0 : (point.position - points_.back().position).norm();
    if (points_.empty() || moved > kShortest_m) {
      distance_.push_back(distance_.empty() ? 0.0 : distance_.back() + moved);
      points_.push_back(point);
      by_time_.push_back(distance_.back());
    } else {
      by_time_.push_back(distance_.back() + moved);
    }
  }
}

double EgoLine::DistanceAt(double time_s) const {
  const double exact = std::clamp(time_s / kStep_s, 0.0, static_cast<double>(by_time_.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(exact), by_time_.size() - 2);
  return by_time_[i] + (exact - static_cast<double>(i)) * (by_time_[i + 1] - by_time_[i]);
}

EgoLine::Point EgoLine::At(double distance_m) const {
  const auto beyond = [&](const Point& end, double by_m) -> Point {
    return {end.position + by_m * Direction(end.yaw_rad), end.yaw_rad};
  };
  if (distance_m <= 0.0) return beyond(points_.front(), distance_m);
  if (distance_m >= distance_.back()) return beyond(points_.back(), distance_m - distance_.back());
  const auto after = std::upper_bound(distance_.begin(), distance_.end(), distance_m);
  const auto i = static_cast<std::size_t>(after - distance_.begin()) - 1;
  const double u = (distance_m - distance_[i]) / (distance_[i + 1] - distance_[i]);
  return {points_[i].position + u * (points_[i + 1].position - points_[i].position),
          points_[i].yaw_rad + u * (points_[i + 1].yaw_rad - points_[i].yaw_rad)};
}

}  // namespace v2vouch::sim
