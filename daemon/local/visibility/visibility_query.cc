// SPDX-License-Identifier: Apache-2.0
// What a sensor sees of one footprint.
#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/local/visibility/bearing_bins.h"
#include "daemon/local/visibility/visibility.h"

namespace v2vouch {
namespace {

constexpr int kRays = 16;
constexpr double kDepthBlur_m = 0.3;
constexpr double kLeastInView = 0.1;
constexpr double kClearShare = 0.9;
constexpr double kOccludedShare = 0.8;
// The outer part of a silhouette, one in so many, decides whether its edge is seen.
constexpr double kEdgeShare = 6.0;

double Ramp(double x, double half_width) {
  if (half_width <= 0.0) return x >= 0.0 ? 1.0 : 0.0;
  return std::clamp(0.5 + 0.5 * x / half_width, 0.0, 1.0);
}

}  // namespace

struct VisibilityMap::Query {
  Query(const Sensor& asked, const Box& about, double distance_m)
      : sensor(asked), footprint(about), centre_m(distance_m) {}

  const Sensor& sensor;
  const Box& footprint;
  double centre_m;
  double azimuth = 0.0;    // Of the footprint's centre, from the sensor's axis.
  bool is_inside = false;  // The whole fan is inside the field of view.
  double limit_cm = 0.0;   // A standing return nearer than this is in front of the footprint.
  bool has_static = false;
  std::size_t count = 0;  // Of in_the_way.
  Fan fan;
  Silhouette target;
  InTheWay in_the_way;

  [[nodiscard]] bool Sees(double a) const {
    const double x = azimuth + a;
    return sensor.Sees(x) || sensor.Sees(x - 2.0 * kPi) || sensor.Sees(x + 2.0 * kPi);
  }
};

// What the rays of a fan meet: sums of their weights.
struct VisibilityMap::Rays {
  double first = 0.0;  // Angle of the first ray, and from one to the next.
  double step = 0.0;
  double weight_sum = 0.0;
  double seen_sum = 0.0;
  double covered_sum = 0.0;
  double uncovered_sum = 0.0;
  double clear_count = 0.0;
  std::array<double, kRays> cover;

  [[nodiscard]] bool IsEdgeCovered(double from_rad, double to_rad) const {
    double covered = 0.0;
    int count_in = 0;
    for (int k = 0; k < kRays; ++k) {
      const double a = first + step * k;
      if (a < from_rad || a > to_rad) continue;
      covered += cover[static_cast<std::size_t>(k)];
      ++count_in;
    }
    return count_in > 0 && covered > 0.5 * count_in;
  }
};

SensorView VisibilityMap::From(SensorKey sensor, const Occluder& footprint) const {
  return See(At(sensor), Box(footprint));
}

View VisibilityMap::Overall(const Occluder& footprint) const {
  return AskAll(nullptr, Box(footprint)).overall;
}

VisibilityMap::Answer VisibilityMap::Ask(SensorKey sensor, const Occluder& footprint) const {
  return AskAll(&At(sensor), Box(footprint));
}

// `first` is asked first, if given: where its view is clear the others are not asked.
VisibilityMap::Answer VisibilityMap::AskAll(const Sensor* first, const Box& footprint) const {
  Answer answer;
  const auto rank = [](View view) {
    switch (view) {
      case View::kClear:
        return 3;
      case View::kUnknown:
        return 2;
      case View::kOccluded:
        return 1;
      case View::kOutOfView:
        break;
    }
    return 0;
  };
  if (first != nullptr) {
    answer.sensor = See(*first, footprint);
    answer.overall = answer.sensor.view;
  }
  for (const Sensor& sensor : sensors_) {
    if (answer.overall == View::kClear) break;
    if (&sensor == first) continue;
    const View view = See(sensor, footprint).view;
    if (rank(view) > rank(answer.overall)) answer.overall = view;
  }
  return answer;
}

// Boxes that may cover a ray of the fan [right, left] (angles from `sight`) nearer than
// `farthest_m`.
std::size_t VisibilityMap::CollectInTheWay(const Box& footprint, const Eigen::Vector2d& p_OS,
                                           const Fan& fan, InTheWay& in_the_way) const {
  std::size_t count = 0;
  const double half_fan = std::max(fan.left_rad, -fan.right_rad);
  const double cos_fan = std::cos(half_fan);
  const double sin_fan = std::sin(half_fan);
  for (const Box& box : occluders_) {
    if (box.id != 0 && box.id == footprint.id) continue;
    const Eigen::Vector2d d = box.centre_O - p_OS;
    const double radius_m =
        0.5 * (box.length_m + box.width_m) + config_.margin_m + box.position_sigma_m;
    const double along_m = d.dot(fan.sight);
    if (along_m > fan.farthest_m + radius_m) continue;
    if (half_fan < 1.0) {  // Else the fan is no wedge worth testing.
      if (along_m < -radius_m) continue;
      const double aside_m = std::abs(fan.sight.x() * d.y() - fan.sight.y() * d.x());
      if (aside_m * cos_fan - along_m * sin_fan > radius_m) continue;
    }
    if (Holds(box, footprint.centre_O, 0.0) || Holds(box, p_OS, 0.0)) continue;
    in_the_way[count].Look(box, p_OS, fan.sight);
    if (++count == in_the_way.size()) break;
  }
  return count;
}

bool VisibilityMap::HasStaticNearer(const Viewpoint& viewpoint, const Fan& fan,
                                    double limit_cm) const {
  const std::size_t last = BinOf(fan.bearing_O + fan.left_rad);
  for (std::size_t bin = BinOf(fan.bearing_O + fan.right_rad);; bin = (bin + 1) % kBins) {
    if (viewpoint.any_cm[bin] < limit_cm) return true;
    if (bin == last) return false;
  }
}

SensorView VisibilityMap::See(const Sensor& sensor, const Box& footprint) const {
  const Eigen::Vector2d& p_OS = sensor.origin_O;
  const Eigen::Vector2d to_centre = footprint.centre_O - p_OS;
  const double sigma_m = footprint.position_sigma_m;
  const double centre_m = to_centre.norm();
  if (centre_m > sensor.max_range_m || centre_m < sensor.min_range_m) return {};
  // Most questions end here. Seen from the sensor the disc is wider than the fan of 3 sigma about
  // the footprint: asin(a) + b <= asin(a + b). It also holds what the next line asks for.
  const double disc_m =
      0.5 * std::hypot(footprint.length_m, footprint.width_m) + 3.0 * sigma_m + 0.2;
  if (sensor.IsSurelyOutside(to_centre, disc_m)) return {};
  if (Holds(footprint, p_OS, 0.1)) return {View::kUnknown, 1.0};  // Upon ourselves.

  Query query(sensor, footprint, centre_m);
  Fan& fan = query.fan;
  Silhouette& target = query.target;
  fan.sight = to_centre / centre_m;
  fan.bearing_O = std::atan2(to_centre.y(), to_centre.x());
  target.Look(footprint, p_OS, fan.sight);
  const double widened = std::min(3.0 * sigma_m / centre_m, 0.5 * kPi);
  fan.right_rad = std::max(target.right_rad - widened, -kPi);
  fan.left_rad = std::min(target.left_rad + widened, kPi);
  fan.farthest_m = centre_m + target.half.norm() + 3.0 * sigma_m;

  // Angles of the fan inside the field of view, which may reach it the other way round the circle.
  query.azimuth = WrapAngle(fan.bearing_O - ego_.X_OB.yaw_rad() - sensor.yaw_rad);
  const double azimuth = query.azimuth;
  query.is_inside = sensor.Sees(azimuth + fan.right_rad) && sensor.Sees(azimuth + fan.left_rad);
  const double past_left = azimuth + fan.right_rad - sensor.fov_left_rad;
  const double past_right = -sensor.fov_right_rad - (azimuth + fan.left_rad);
  if (std::max(past_left, past_right) > 0.0 && std::abs(azimuth) < kPi - 0.5 && widened < 0.25) {
    return {};  // Far off the axis, and not by way of the seam.
  }

  query.limit_cm = 100.0 * (target.nearest_m - config_.margin_m - config_.static_cell_m - sigma_m);
  const bool stays_in_range = centre_m + 3.0 * sigma_m <= sensor.max_range_m &&
                              target.nearest_m - 3.0 * sigma_m >= sensor.min_range_m;
  query.count = CollectInTheWay(footprint, p_OS, fan, query.in_the_way);
  query.has_static = HasStaticNearer(viewpoints_[sensor.viewpoint], fan, query.limit_cm);
  if (query.count == 0 && !query.has_static && query.is_inside && stays_in_range) {
    return {View::kClear, 1.0};
  }
  return Conclude(target, CastRays(query), stays_in_range);
}

SensorView VisibilityMap::Conclude(const Silhouette& target, const Rays& rays,
                                   bool stays_in_range) {
  if (!(rays.seen_sum >= kLeastInView * rays.weight_sum) || rays.seen_sum <= 0.0) return {};
  SensorView result = {View::kUnknown, rays.uncovered_sum / rays.weight_sum};
  const double edge_rad = std::max((target.left_rad - target.right_rad) / kEdgeShare, rays.step);
  result.left_is_covered = rays.IsEdgeCovered(target.left_rad - edge_rad, target.left_rad);
  result.right_is_covered = rays.IsEdgeCovered(target.right_rad, target.right_rad + edge_rad);
  if (rays.clear_count >= kClearShare * kRays && stays_in_range) {
    result.view = View::kClear;
  } else if (rays.covered_sum >= kOccludedShare * rays.seen_sum) {
    result.view = View::kOccluded;
  }
  return result;
}

// How far the boxes in the way cover the ray at angle `a`; 1 = wholly.
double VisibilityMap::CoverOf(const Query& query, double a, const Eigen::Vector2d& ray) const {
  const Silhouette& target = query.target;
  const double sigma_m = query.footprint.position_sigma_m;
  double covered = 0.0;
  double target_m = -1.0;  // Where the ray enters the footprint, once it is asked for.
  for (std::size_t i = 0; i < query.count && covered < 1.0; ++i) {
    const Silhouette& box = query.in_the_way[i];
    const double blur_m = config_.margin_m + box.sigma_m;
    const double inside_rad = std::min(a - box.right_rad, box.left_rad - a);
    // A ray that passes the nearest point of the box by more than the blur passes all of it.
    if (inside_rad * box.nearest_m < -1.001 * blur_m) continue;
    if (target_m < 0.0) target_m = target.EntryAlong(ray, query.centre_m);
    const double entry_m = box.EntryAlong(ray, box.centre_m);
    covered = std::max(covered, Ramp(inside_rad * entry_m, blur_m) *
                                    Ramp(target_m - entry_m, kDepthBlur_m + sigma_m + box.sigma_m));
  }
  return covered;
}

VisibilityMap::Rays VisibilityMap::CastRays(const Query& query) const {
  const Viewpoint& viewpoint = viewpoints_[query.sensor.viewpoint];
  const Fan& fan = query.fan;
  const Silhouette& target = query.target;
  Rays rays;
  rays.step = (fan.left_rad - fan.right_rad) / kRays;
  rays.first = fan.right_rad + 0.5 * rays.step;
  const double step = rays.step;
  Eigen::Matrix2d turn;
  turn << std::cos(step), -std::sin(step), std::sin(step), std::cos(step);
  Eigen::Vector2d ray(std::cos(fan.bearing_O + rays.first), std::sin(fan.bearing_O + rays.first));
  for (int k = 0; k < kRays; ++k, ray = turn * ray) {
    const double a = rays.first + step * k;
    const double inside_m = std::min(a - target.right_rad, target.left_rad - a) * query.centre_m;
    const double weight = Ramp(inside_m, 3.0 * query.footprint.position_sigma_m);
    rays.weight_sum += weight;
    rays.cover[static_cast<std::size_t>(k)] = 1.0;
    if (!query.is_inside && !query.Sees(a)) continue;

    double covered = CoverOf(query, a, ray);
    double possibly = covered;
    if (query.has_static) {
      const std::size_t bin = BinOf(fan.bearing_O + a);
      if (viewpoint.any_cm[bin] < query.limit_cm) possibly = 1.0;
      if (viewpoint.structure_cm[bin] < query.limit_cm) covered = 1.0;
    }
    rays.cover[static_cast<std::size_t>(k)] = covered;
    rays.seen_sum += weight;
    rays.covered_sum += weight * covered;
    rays.uncovered_sum += weight * (1.0 - 0.5 * (covered + possibly));
    rays.clear_count += 1.0 - possibly;
  }
  return rays;
}

}  // namespace v2vouch
