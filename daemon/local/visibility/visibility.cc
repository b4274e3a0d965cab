// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/visibility/visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/check.h"

namespace v2vouch {
namespace {

constexpr double kBinSize = 2.0 * kPi / 360.0;
constexpr std::uint16_t kNoReturn = std::numeric_limits<std::uint16_t>::max();
constexpr double kSharedViewpoint_m = 2.5;
// How old the bins may get, in time and in the ego's path, before they are built again. They hang
// on directions in O, so the ego's turning does not age them.
constexpr double kBinsAge_s = 0.1;
constexpr double kBinsPath_m = 0.3;

constexpr int kRays = 16;
constexpr double kDepthBlur_m = 0.3;
constexpr double kLeastInView = 0.1;
constexpr double kClearShare = 0.9;
constexpr double kOccludedShare = 0.8;
// The outer part of a silhouette, one in so many, decides whether its edge is seen.
constexpr double kEdgeShare = 6.0;

// `bearing_O` within three half circles.
std::size_t BinOf(double bearing_O) {
  const int bin = static_cast<int>((bearing_O + 3.0 * kPi) / kBinSize);
  return static_cast<std::size_t>(std::clamp(bin, 0, 3 * 360 - 1) % 360);
}

double Ramp(double x, double half_width) {
  if (half_width <= 0.0) return x >= 0.0 ? 1.0 : 0.0;
  return std::clamp(0.5 + 0.5 * x / half_width, 0.0, 1.0);
}

}  // namespace

VisibilityMap::VisibilityMap(const VisibilityConfig& config, const VehicleConfig& vehicle)
    : config_(config),
      radar_count_(vehicle.radars.size()),
      raster_(config.static_cell_m, config.static_hold_s, config.static_min_hits) {
  for (const RadarConfig& radar : vehicle.radars) {
    AddSensor({.p_B = {radar.x_m, radar.y_m},
               .yaw_rad = radar.yaw_rad,
               .fov_left_rad = radar.half_fov_rad,
               .fov_right_rad = radar.half_fov_rad,
               .min_range_m = radar.min_range_m,
               .max_range_m = radar.max_range_m});
  }
  for (const CameraConfig& camera : vehicle.cameras) {
    AddSensor({.p_B = {camera.x_m, camera.y_m},
               .yaw_rad = camera.yaw_rad,
               .fov_left_rad = std::atan2(camera.cx_px, camera.fx_px),
               .fov_right_rad = std::atan2(camera.image_width_px - camera.cx_px, camera.fx_px),
               .min_range_m = 0.0,
               .max_range_m = camera.max_range_m});
  }
}

void VisibilityMap::AddSensor(const Sensor& sensor) {
  std::size_t index = 0;
  while (index < viewpoints_.size() &&
         (viewpoints_[index].p_B - sensor.p_B).norm() > kSharedViewpoint_m) {
    ++index;
  }
  if (index == viewpoints_.size()) {
    viewpoints_.push_back({.p_B = sensor.p_B});
    viewpoints_.back().structure_cm.fill(kNoReturn);
    viewpoints_.back().any_cm.fill(kNoReturn);
  }
  Sensor& added = sensors_.emplace_back(sensor);
  added.viewpoint = index;
  constexpr double kSize = 2.0 * kPi / kSectors;
  for (int i = 0; i < kSectors; ++i) {
    const double middle_rad = 0.5 * ((-kPi + kSize * i) + (-kPi + kSize * (i + 1)));
    added.covers[static_cast<std::size_t>(i)] = added.Sees(WrapAngle(middle_rad - added.yaw_rad));
  }
  const auto direction = [](double a) { return Eigen::Vector2d(std::cos(a), std::sin(a)); };
  added.left_B = direction(added.yaw_rad + added.fov_left_rad);
  added.right_B = direction(added.yaw_rad - added.fov_right_rad);
  added.Place(ego_.X_OB, ego_.X_OB.rotation());
}

void VisibilityMap::Sensor::Place(const Pose<Odometry, Body>& X_OB, const Eigen::Matrix2d& R_OB) {
  origin_O = (X_OB * Point<Body>{p_B.x(), p_B.y()}).vector();
  left_O = R_OB * left_B;
  right_O = R_OB * right_B;
}

// Up to half a circle of view, all of it lies on one side of the line through either edge.
bool VisibilityMap::Sensor::IsSurelyOutside(const Eigen::Vector2d& d, double radius_m) const {
  if (fov_left_rad + fov_right_rad > kPi) return false;
  return left_O.x() * d.y() - left_O.y() * d.x() > radius_m ||
         d.x() * right_O.y() - d.y() * right_O.x() > radius_m;
}

void VisibilityMap::AccumulateStatic(Timestamp stamp, const EgoState& ego,
                                     std::span<const RadarMeasurement> measurements) {
  const Eigen::Matrix2d R_OB = ego.X_OB.rotation();
  for (const RadarMeasurement& m : measurements) {
    if (!m.is_static || m.radar < 0 || static_cast<std::size_t>(m.radar) >= radar_count_) continue;
    const Sensor& sensor = sensors_[static_cast<std::size_t>(m.radar)];
    const auto add = [&](double azimuth_rad) {
      const double bearing_B = sensor.yaw_rad + azimuth_rad;
      const double x_m = sensor.p_B.x() + m.range_m * std::cos(bearing_B);
      const double y_m = sensor.p_B.y() + m.range_m * std::sin(bearing_B);
      const Eigen::Vector2d p_O(ego.X_OB.x_m() + R_OB(0, 0) * x_m - R_OB(1, 0) * y_m,
                                ego.X_OB.y_m() + R_OB(1, 0) * x_m + R_OB(0, 0) * y_m);
      for (const Box& box : occluders_) {
        if (Holds(box, p_O, config_.margin_m + box.position_sigma_m)) return;
      }
      raster_.Add(stamp, p_O);
    };
    // A wide flat cluster is a piece of wall across the ray: its reflections, no farther apart than
    // one clustering radius, stand for the wall between them. Of an oblique one only the mean is
    // known to lie on it.
    const double width_m = m.range_m * (m.azimuth_max_rad - m.azimuth_min_rad);
    if (width_m > config_.static_cell_m && m.radial_extent_m < 2.0) {
      const int steps = std::min(12, static_cast<int>(width_m / config_.static_cell_m));
      for (int i = 0; i <= steps; ++i) {
        add(m.azimuth_min_rad + (m.azimuth_max_rad - m.azimuth_min_rad) * i / steps);
      }
    } else {
      add(m.azimuth_rad);
    }
  }
}

void VisibilityMap::SeeThrough(const RadarMeasurement& measurement) {
  const Sensor& sensor = RadarAt(measurement.radar);
  const double bearing_O = ego_.X_OB.yaw_rad() + sensor.yaw_rad + measurement.azimuth_rad;
  const double reach_m = measurement.near_range_m - config_.margin_m - 2.0 * config_.static_cell_m;
  // The bins know whether there is anything to clear away.
  const Viewpoint& viewpoint = viewpoints_[sensor.viewpoint];
  if (reach_m <= 0.0 || viewpoint.any_cm[BinOf(bearing_O)] >= 100.0 * reach_m) return;
  const Eigen::Vector2d ray(std::cos(bearing_O), std::sin(bearing_O));
  raster_.SeeThrough(sensor.origin_O, sensor.origin_O + reach_m * ray);
}

void VisibilityMap::SetScene(const EgoState& ego, std::span<const Occluder> occluders) {
  ego_ = ego;
  const Eigen::Matrix2d R_OB = ego.X_OB.rotation();
  for (Sensor& sensor : sensors_) sensor.Place(ego.X_OB, R_OB);
  occluders_.clear();
  for (const Occluder& occluder : occluders) occluders_.emplace_back(occluder);
  const double age_s = ToSeconds(ego.stamp - bins_built_);
  const bool is_due = !has_bins_ || age_s < 0.0 || age_s >= kBinsAge_s;
  for (Viewpoint& viewpoint : viewpoints_) {
    const Point<Odometry> p = ego.X_OB * Point<Body>{viewpoint.p_B.x(), viewpoint.p_B.y()};
    if (!is_due && (p.vector() - viewpoint.built_at_O).norm() < kBinsPath_m) continue;
    viewpoint.built_at_O = p.vector();
    RebuildBins(viewpoint);
  }
  if (is_due) bins_built_ = ego.stamp;
  has_bins_ = true;
}

void VisibilityMap::RebuildBins(Viewpoint& viewpoint) const {
  viewpoint.structure_cm.fill(kNoReturn);
  viewpoint.any_cm.fill(kNoReturn);
  const Eigen::Vector2d p_OV = viewpoint.built_at_O;
  raster_.ForEachActive(ego_.stamp, p_OV, [&](const Eigen::Vector2d& p_O, bool is_structure) {
    const Eigen::Vector2d d = p_O - p_OV;
    const double range_m = d.norm();
    if (range_m < config_.static_cell_m || range_m > 600.0) return;
    const double bearing = std::atan2(d.y(), d.x());
    const double half_width = 0.5 * config_.static_cell_m / range_m;
    const auto range_cm = static_cast<std::uint16_t>(range_m * 100.0);
    const std::size_t first = BinOf(bearing - half_width);
    const std::size_t last = BinOf(bearing + half_width);
    for (std::size_t bin = first;; bin = (bin + 1) % kBins) {
      viewpoint.any_cm[bin] = std::min(viewpoint.any_cm[bin], range_cm);
      if (is_structure) {
        viewpoint.structure_cm[bin] = std::min(viewpoint.structure_cm[bin], range_cm);
      }
      if (bin == last) break;
    }
  });
}

const VisibilityMap::Sensor& VisibilityMap::RadarAt(int index) const {
  V2VOUCH_CHECK(index >= 0 && static_cast<std::size_t>(index) < radar_count_);
  return sensors_[static_cast<std::size_t>(index)];
}

const VisibilityMap::Sensor& VisibilityMap::CameraAt(int index) const {
  V2VOUCH_CHECK(index >= 0 && radar_count_ + static_cast<std::size_t>(index) < sensors_.size());
  return sensors_[radar_count_ + static_cast<std::size_t>(index)];
}

SensorView VisibilityMap::FromRadar(int index, const Occluder& footprint) const {
  return See(RadarAt(index), Box(footprint));
}

SensorView VisibilityMap::FromCamera(int index, const Occluder& footprint) const {
  return See(CameraAt(index), Box(footprint));
}

bool VisibilityMap::HasStandingReturn(const Eigen::Vector2d& p_O, double within_m) const {
  bool is_there = false;
  raster_.ForEachActive(ego_.stamp, {ego_.X_OB.x_m(), ego_.X_OB.y_m()},
                        [&](const Eigen::Vector2d& cell_O, bool /*is_structure*/) {
                          is_there = is_there || (cell_O - p_O).squaredNorm() < within_m * within_m;
                        });
  return is_there;
}

View VisibilityMap::Overall(const Occluder& footprint) const {
  return Ask(nullptr, Box(footprint)).overall;
}

VisibilityMap::Answer VisibilityMap::AskRadar(int index, const Occluder& footprint) const {
  return Ask(&RadarAt(index), Box(footprint));
}

VisibilityMap::Answer VisibilityMap::AskCamera(int index, const Occluder& footprint) const {
  return Ask(&CameraAt(index), Box(footprint));
}

// `first` is asked first, if given: where its view is clear the others are not asked.
VisibilityMap::Answer VisibilityMap::Ask(const Sensor* first, const Box& footprint) const {
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

  Fan fan;
  fan.sight = to_centre / centre_m;
  fan.bearing_O = std::atan2(to_centre.y(), to_centre.x());
  Silhouette target;
  target.Look(footprint, p_OS, fan.sight);
  const double widened = std::min(3.0 * sigma_m / centre_m, 0.5 * kPi);
  fan.right_rad = std::max(target.right_rad - widened, -kPi);
  fan.left_rad = std::min(target.left_rad + widened, kPi);
  fan.farthest_m = centre_m + target.half.norm() + 3.0 * sigma_m;

  // Angles of the fan inside the field of view, which may reach it the other way round the circle.
  const double azimuth = WrapAngle(fan.bearing_O - ego_.X_OB.yaw_rad() - sensor.yaw_rad);
  const auto sees = [&](double a) {
    const double x = azimuth + a;
    return sensor.Sees(x) || sensor.Sees(x - 2.0 * kPi) || sensor.Sees(x + 2.0 * kPi);
  };
  const bool is_inside =
      sensor.Sees(azimuth + fan.right_rad) && sensor.Sees(azimuth + fan.left_rad);
  const double past_left = azimuth + fan.right_rad - sensor.fov_left_rad;
  const double past_right = -sensor.fov_right_rad - (azimuth + fan.left_rad);
  if (std::max(past_left, past_right) > 0.0 && std::abs(azimuth) < kPi - 0.5 && widened < 0.25) {
    return {};  // Far off the axis, and not by way of the seam.
  }

  const Viewpoint& viewpoint = viewpoints_[sensor.viewpoint];
  const double limit_cm =
      100.0 * (target.nearest_m - config_.margin_m - config_.static_cell_m - sigma_m);
  const bool stays_in_range = centre_m + 3.0 * sigma_m <= sensor.max_range_m &&
                              target.nearest_m - 3.0 * sigma_m >= sensor.min_range_m;
  InTheWay in_the_way;
  const std::size_t count = CollectInTheWay(footprint, p_OS, fan, in_the_way);
  const bool has_static = HasStaticNearer(viewpoint, fan, limit_cm);
  if (count == 0 && !has_static && is_inside && stays_in_range) return {View::kClear, 1.0};

  double weight_sum = 0.0;
  double seen_sum = 0.0;
  double covered_sum = 0.0;
  double uncovered_sum = 0.0;
  double clear_count = 0.0;
  std::array<double, kRays> cover;
  const double step = (fan.left_rad - fan.right_rad) / kRays;
  const double first = fan.right_rad + 0.5 * step;
  Eigen::Matrix2d turn;
  turn << std::cos(step), -std::sin(step), std::sin(step), std::cos(step);
  Eigen::Vector2d ray(std::cos(fan.bearing_O + first), std::sin(fan.bearing_O + first));
  for (int k = 0; k < kRays; ++k, ray = turn * ray) {
    const double a = first + step * k;
    const double inside_m = std::min(a - target.right_rad, target.left_rad - a) * centre_m;
    const double weight = Ramp(inside_m, 3.0 * sigma_m);
    weight_sum += weight;
    cover[static_cast<std::size_t>(k)] = 1.0;
    if (!is_inside && !sees(a)) continue;

    double covered = 0.0;
    double target_m = -1.0;  // Where the ray enters the footprint, once it is asked for.
    for (std::size_t i = 0; i < count && covered < 1.0; ++i) {
      const Silhouette& box = in_the_way[i];
      const double blur_m = config_.margin_m + box.sigma_m;
      const double inside_rad = std::min(a - box.right_rad, box.left_rad - a);
      // A ray that passes the nearest point of the box by more than the blur passes all of it.
      if (inside_rad * box.nearest_m < -1.001 * blur_m) continue;
      if (target_m < 0.0) target_m = target.EntryAlong(ray, centre_m);
      const double entry_m = box.EntryAlong(ray, box.centre_m);
      covered =
          std::max(covered, Ramp(inside_rad * entry_m, blur_m) *
                                Ramp(target_m - entry_m, kDepthBlur_m + sigma_m + box.sigma_m));
    }
    double possibly = covered;
    if (has_static) {
      const std::size_t bin = BinOf(fan.bearing_O + a);
      if (viewpoint.any_cm[bin] < limit_cm) possibly = 1.0;
      if (viewpoint.structure_cm[bin] < limit_cm) covered = 1.0;
    }
    cover[static_cast<std::size_t>(k)] = covered;
    seen_sum += weight;
    covered_sum += weight * covered;
    uncovered_sum += weight * (1.0 - 0.5 * (covered + possibly));
    clear_count += 1.0 - possibly;
  }

  const auto is_edge_covered = [&](double from_rad, double to_rad) {
    double covered = 0.0;
    int count_in = 0;
    for (int k = 0; k < kRays; ++k) {
      const double a = first + step * k;
      if (a < from_rad || a > to_rad) continue;
      covered += cover[static_cast<std::size_t>(k)];
      ++count_in;
    }
    return count_in > 0 && covered > 0.5 * count_in;
  };
  if (!(seen_sum >= kLeastInView * weight_sum) || seen_sum <= 0.0) return {};
  SensorView result = {View::kUnknown, uncovered_sum / weight_sum};
  const double edge_rad = std::max((target.left_rad - target.right_rad) / kEdgeShare, step);
  result.left_is_covered = is_edge_covered(target.left_rad - edge_rad, target.left_rad);
  result.right_is_covered = is_edge_covered(target.right_rad, target.right_rad + edge_rad);
  if (clear_count >= kClearShare * kRays && stays_in_range) {
    result.view = View::kClear;
  } else if (covered_sum >= kOccludedShare * seen_sum) {
    result.view = View::kOccluded;
  }
  return result;
}

Occluder FootprintOf(const LocalTrack& track) {
  const auto& P = track.state_O.covariance;
  return {.id = track.id,
          .centre_O = track.state_O.mean.head<2>(),
          .yaw_rad = track.state_O.mean[kYaw],
          .length_m = track.extent.length_m,
          .width_m = track.extent.width_m,
          .position_sigma_m = std::sqrt(std::max(0.0, 0.5 * (P(kX, kX) + P(kY, kY))))};
}

}  // namespace v2vouch
