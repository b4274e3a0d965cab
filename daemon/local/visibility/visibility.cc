// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/visibility/visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/check.h"
#include "daemon/local/visibility/bearing_bins.h"

namespace v2vouch {
namespace {

constexpr std::uint16_t kNoReturn = std::numeric_limits<std::uint16_t>::max();
constexpr double kSharedViewpoint_m = 2.5;
// How old the bins may get, in time and in the ego's path, before they are built again. They hang
// on directions in O, so the ego's turning does not age them.
constexpr double kBinsAge_s = 0.1;
constexpr double kBinsPath_m = 0.3;
}  // namespace

VisibilityMap::VisibilityMap(const VisibilityConfig& config, const VehicleConfig& vehicle)
    : config_(config), raster_(config.static_cell_m, config.static_hold_s, config.static_min_hits) {
  for (const RadarConfig& radar : vehicle.radars) {
    AddSensor({.kind = SensorKind::kRadar,
               .p_B = {radar.x_m, radar.y_m},
               .yaw_rad = radar.yaw_rad,
               .fov_left_rad = radar.half_fov_rad,
               .fov_right_rad = radar.half_fov_rad,
               .min_range_m = radar.min_range_m,
               .max_range_m = radar.max_range_m});
  }
  first_[1] = sensors_.size();
  for (const CameraConfig& camera : vehicle.cameras) {
    AddSensor({.kind = SensorKind::kCamera,
               .p_B = {camera.x_m, camera.y_m},
               .yaw_rad = camera.yaw_rad,
               .fov_left_rad = std::atan2(camera.cx_px, camera.fx_px),
               .fov_right_rad = std::atan2(camera.image_width_px - camera.cx_px, camera.fx_px),
               .min_range_m = 0.0,
               .max_range_m = camera.max_range_m});
  }
  first_[2] = sensors_.size();
  for (const ObjectSensorConfig& source : vehicle.objects) {
    AddSensor({.kind = SensorKind::kObjects,
               .p_B = {source.x_m, source.y_m},
               .yaw_rad = source.yaw_rad,
               .fov_left_rad = source.half_fov_rad,
               .fov_right_rad = source.half_fov_rad,
               .min_range_m = source.min_range_m,
               .max_range_m = source.max_range_m});
  }
  first_[3] = sensors_.size();
  static_assert(kSensorKinds == 3);
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
    if (!m.is_static || m.radar < 0 || static_cast<std::size_t>(m.radar) >= first_[1]) continue;
    const Sensor& sensor = At({SensorKind::kRadar, m.radar});
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
  const Sensor& sensor = At({SensorKind::kRadar, measurement.radar});
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

const VisibilityMap::Sensor& VisibilityMap::At(SensorKey sensor) const {
  const auto kind = static_cast<std::size_t>(sensor.kind);
  const std::size_t at = first_[kind] + static_cast<std::size_t>(sensor.index);
  V2VOUCH_CHECK(sensor.index >= 0 && at < first_[kind + 1]);
  return sensors_[at];
}

bool VisibilityMap::HasStandingReturn(const Eigen::Vector2d& p_O, double within_m) const {
  bool is_there = false;
  raster_.ForEachActive(ego_.stamp, {ego_.X_OB.x_m(), ego_.X_OB.y_m()},
                        [&](const Eigen::Vector2d& cell_O, bool /*is_structure*/) {
                          is_there = is_there || (cell_O - p_O).squaredNorm() < within_m * within_m;
                        });
  return is_there;
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
