// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/models/radar_outline.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/dual.h"
#include "daemon/common/models/outline_noise.h"

namespace v2vouch {
namespace {

using D = Dual<kStateSize + 2>;

// Strong returns lie behind the outline by this much on average: bumpers are rounded, plates and
// lamps lie behind them.
constexpr double kDepth_m = 0.1;
// What lies deeper than the median return by more than this counts less.
constexpr double kDeep_m = 0.5;
// From here on the returns are less believed.
constexpr double kDeepSigmas = 1.5;
constexpr double kNearSigmas = 3.0;
// Where a ray misses the box, a metre of range weighs as much as so much beside the ray.
constexpr double kNearer = 0.2;

// The vehicle's box, with the antenna in its axes.
struct Box {
  D sensor_x, sensor_y;
  D half_length, half_width;
  D c, s;
};

// A point of the outline seen from the antenna: how far, and how far beside the ray.
struct OutlinePoint {
  D range;
  double aside_m = 0.0;
};

// Of a face's line, given by its distance `off` along `n` and its half `width` across, the point
// nearest to the ray. `d`: the ray, `o`: the antenna, both along and across the face's normal.
OutlinePoint NearestOnFace(const D& off, const D& width, const D& o_along, const D& o_across,
                           const D& d_along, const D& d_across) {
  const D gap = off - o_along;
  const double t = gap.value / d_along.value;
  const double hit = o_across.value + t * d_across.value;
  if (t > 0.0 && std::abs(hit) <= width.value) return {gap / d_along, 0.0};
  const double side = (t > 0.0 ? hit : -hit) > 0.0 ? 1.0 : -1.0;
  const D across = side * width - o_across;
  const D range = sqrt(gap * gap + across * across);
  const double beside = gap.value * d_across.value - across.value * d_along.value;
  return {range, std::abs(beside)};
}

// Distance along the ray at `bearing_O` to the outline; where it misses the box, to the nearest
// point of the faces that are seen. A face seen at so small an angle that azimuth noise passes
// over it counts only where it is the only one.
D RangeAlong(const Box& box, double bearing_O, double azimuth_sigma_rad) {
  const double cos_b = std::cos(bearing_O);
  const double sin_b = std::sin(bearing_O);
  const D dx = cos_b * box.c + sin_b * box.s;
  const D dy = sin_b * box.c - cos_b * box.s;
  const double sx = box.sensor_x.value;
  const double sy = box.sensor_y.value;
  const double beyond_x = std::abs(sx) - box.half_length.value;
  const double beyond_y = std::abs(sy) - box.half_width.value;
  const double range2 = sx * sx + sy * sy;
  // Angles under which the two faces show.
  const double end_rad = beyond_x * 2.0 * box.half_width.value / range2;
  const double flank_rad = beyond_y * 2.0 * box.half_length.value / range2;
  const double least_rad = 2.0 * azimuth_sigma_rad;
  const bool sees_end = beyond_x > 0.0 && (end_rad > least_rad || end_rad >= flank_rad);
  const bool sees_flank = beyond_y > 0.0 && (flank_rad > least_rad || flank_rad > end_rad);
  const D end_off = (sx > 0.0 ? 1.0 : -1.0) * box.half_length;
  const D flank_off = (sy > 0.0 ? 1.0 : -1.0) * box.half_width;
  if (!sees_flank) {
    return NearestOnFace(end_off, box.half_width, box.sensor_x, box.sensor_y, dx, dy).range;
  }
  const OutlinePoint flank =
      NearestOnFace(flank_off, box.half_length, box.sensor_y, box.sensor_x, dy, dx);
  if (!sees_end) return flank.range;
  const OutlinePoint end =
      NearestOnFace(end_off, box.half_width, box.sensor_x, box.sensor_y, dx, dy);
  if (end.aside_m == 0.0) return end.range;
  if (flank.aside_m == 0.0) return flank.range;
  // Beside the box: the nearer point, unless the other is clearly closer to the ray.
  const double end_cost = end.aside_m + kNearer * end.range.value;
  const double flank_cost = flank.aside_m + kNearer * flank.range.value;
  return end_cost <= flank_cost ? end.range : flank.range;
}

// The vehicle as a radar has it before itself, axes of O.
struct Scene {
  Scene(const StateVector& x, const Extent& extent, const EgoState& ego, const RadarConfig& radar) {
    const Pose<Odometry, Radar> X_OR =
        ego.X_OB * Pose<Body, Radar>(radar.x_m, radar.y_m, radar.yaw_rad);
    sensor_yaw_rad = X_OR.yaw_rad();
    px = D::Variable(x[kX] - X_OR.x_m(), kX);
    py = D::Variable(x[kY] - X_OR.y_m(), kY);
    const D yaw = D::Variable(x[kYaw], kYaw);
    c = cos(yaw);
    s = sin(yaw);
    box = {D(0.0) - (c * px + s * py),
           s * px - c * py,
           0.5 * D::Variable(extent.length_m, kStateSize),
           0.5 * D::Variable(extent.width_m, kStateSize + 1),
           c,
           s};
  }
  [[nodiscard]] bool IsInside() const {
    return std::abs(box.sensor_x.value) < box.half_length.value &&
           std::abs(box.sensor_y.value) < box.half_width.value;
  }
  double sensor_yaw_rad = 0.0;
  D px, py, c, s;
  Box box;
};

struct Silhouette {
  D left_O, right_O;
};

// Bearings between the outermost corners, as far as the field of view reaches.
Silhouette SilhouetteOf(const Scene& scene, double half_fov_rad) {
  const auto& [sensor_yaw_rad, px, py, c, s, box] = scene;
  const D centre = atan2(py, px);
  D left = centre;
  D right = centre;
  for (const double along : {1.0, -1.0}) {
    for (const double across : {1.0, -1.0}) {
      const D ahead = along * box.half_length;
      const D aside = across * box.half_width;
      const D x = px + c * ahead - s * aside;
      const D y = py + s * ahead + c * aside;
      // Relative to the centre, so that no corner jumps at half a turn.
      const D apart = atan2(px * y - py * x, px * x + py * y);
      const D bearing = centre + apart;
      if (bearing.value > left.value) left = bearing;
      if (bearing.value < right.value) right = bearing;
    }
  }
  if (half_fov_rad < kPi) {
    const double axis = centre.value + AngleDifference(sensor_yaw_rad, centre.value);
    const double most = axis + half_fov_rad;
    const double least = axis - half_fov_rad;
    if (left.value > most && right.value < most) left = D(most);
    if (right.value < least && left.value > least) right = D(least);
  }
  return {left, right};
}

// Mean distance of the returns behind the outline, deep ones counting less, with derivatives.
struct Depth {
  double innovation_m = 0.0;
  D predicted;
  double count = 0.0;  // Returns that it rests on.
};

Depth MeanDepth(const Box& box, double sensor_yaw_rad, double azimuth_sigma_rad,
                const RadarMeasurement& z) {
  std::array<D, RadarMeasurement::kMostOutline> ranges;
  std::array<double, RadarMeasurement::kMostOutline> off{};
  std::array<double, RadarMeasurement::kMostOutline> sorted{};
  for (std::size_t k = 0; k < z.outline_count; ++k) {
    ranges[k] = RangeAlong(box, z.outline[k].azimuth_rad + sensor_yaw_rad, azimuth_sigma_rad);
    off[k] = z.outline[k].range_m - ranges[k].value;
    sorted[k] = off[k];
  }
  std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(z.outline_count));
  const double median = sorted[(z.outline_count - 1) / 2];
  Depth out;
  out.predicted = D(0.0);
  for (std::size_t k = 0; k < z.outline_count; ++k) {
    const double deep = off[k] - median;
    const double weight = deep > kDeep_m ? kDeep_m / deep : 1.0;
    out.innovation_m += weight * off[k];
    out.predicted = out.predicted + weight * ranges[k];
    out.count += weight;
  }
  out.innovation_m = out.innovation_m / out.count - kDepth_m;
  out.predicted = (1.0 / out.count) * out.predicted;
  return out;
}

}  // namespace

std::optional<Linearized> LinearizeOutline(const StateVector& x, const Extent& extent,
                                           const EgoState& ego, const RadarConfig& radar,
                                           const RadarMeasurement& z) {
  const Scene scene(x, extent, ego, radar);
  if (scene.IsInside()) return std::nullopt;
  const auto& [sensor_yaw_rad, px, py, c, s, box] = scene;
  const Depth depth = MeanDepth(box, sensor_yaw_rad, radar.azimuth_sigma_rad, z);
  const Silhouette silhouette = SilhouetteOf(scene, radar.half_fov_rad);
  const D middle_O = 0.5 * (silhouette.left_O + silhouette.right_O);
  const double half_rad = 0.5 * (silhouette.left_O.value - silhouette.right_O.value);

  // The outline's returns move with the body: at their own bearing.
  const double bearing = z.azimuth_rad + sensor_yaw_rad;
  const Eigen::Vector2d u(std::cos(bearing), std::sin(bearing));
  const Eigen::Vector2d q = z.range_m * u;
  const D speed = D::Variable(x[kSpeed], kSpeed);
  const D yaw_rate = D::Variable(x[kYawRate], kYawRate);
  const D vx = speed * c - yaw_rate * (D(q.y()) - py);
  const D vy = speed * s + yaw_rate * (D(q.x()) - px);
  const Eigen::Matrix2d R_OB = ego.X_OB.rotation();
  const Eigen::Vector2d antenna = R_OB * AntennaVelocity_B(ego, radar);
  const D range_rate = u.x() * (vx - D(antenna.x())) + u.y() * (vy - D(antenna.y()));

  Linearized out;
  out.y.resize(3);
  out.H.resize(3, Eigen::NoChange);
  out.E.resize(3, Eigen::NoChange);
  out.O.setZero(3, 2);
  const D* const rows[3] = {&depth.predicted, &middle_O, &range_rate};
  for (int i = 0; i < 3; ++i) {
    out.H.row(i) = rows[i]->gradient.head<kStateSize>();
    out.E.row(i) = rows[i]->gradient.tail<2>();
  }
  out.y << depth.innovation_m, WrapAngle(z.middle_azimuth_rad + sensor_yaw_rad - middle_O.value),
      z.range_rate_mps - range_rate.value;
  out.O(0, 0) = 1.0;
  out.O(1, 1) = half_rad;

  out.R = OutlineNoise(ego, radar, z,
                       {.depth_count = depth.count,
                        .half_rad = half_rad,
                        .line_O = u,
                        .passing_O = {vx.value - antenna.x(), vy.value - antenna.y()},
                        .lever_O = {q.x() - px.value, q.y() - py.value}});
  const Eigen::Vector2d extent_variance(Square(extent.length_sigma_m),
                                        Square(extent.width_sigma_m));
  out.R += out.E * extent_variance.asDiagonal() * out.E.transpose();
  return out;
}

std::optional<Linearized> LinearizeEdges(const StateVector& x, const Extent& extent,
                                         const EgoState& ego, const RadarConfig& radar,
                                         const RadarMeasurement& z) {
  if (z.outline_count == 0) return std::nullopt;
  const Scene scene(x, extent, ego, radar);
  if (scene.IsInside()) return std::nullopt;
  const Silhouette silhouette = SilhouetteOf(scene, kPi);  // Wherever the field of view ends.
  const double noise_rad = radar.azimuth_sigma_rad * std::sqrt(1.0 + std::log(z.outline_count));
  double leftmost_rad = z.outline[0].azimuth_rad;
  double rightmost_rad = leftmost_rad;
  for (std::size_t k = 1; k < z.outline_count; ++k) {
    leftmost_rad = std::max(leftmost_rad, z.outline[k].azimuth_rad);
    rightmost_rad = std::min(rightmost_rad, z.outline[k].azimuth_rad);
  }
  const double left =
      WrapAngle(leftmost_rad + scene.sensor_yaw_rad - silhouette.left_O.value) - noise_rad;
  const double right =
      WrapAngle(silhouette.right_O.value - rightmost_rad - scene.sensor_yaw_rad) - noise_rad;
  if (left <= 0.0 && right <= 0.0) return std::nullopt;
  // A cluster that sticks out on both sides is wider than the vehicle: it tells nothing of where.
  if (left > 0.0 && right > 0.0) return std::nullopt;
  const D& edge = left > 0.0 ? silhouette.left_O : silhouette.right_O;
  Linearized out;
  out.y.resize(1);
  out.y[0] = left > 0.0 ? left : -right;
  out.H = edge.gradient.head<kStateSize>();
  out.E = edge.gradient.tail<2>();
  const double sigma_rad = std::hypot(radar.azimuth_sigma_rad, kRadarEdgeSigma_m / z.range_m);
  out.R.resize(1, 1);
  out.R(0, 0) = sigma_rad * sigma_rad;
  const Eigen::Vector2d extent_variance(extent.length_sigma_m * extent.length_sigma_m,
                                        extent.width_sigma_m * extent.width_sigma_m);
  out.R += out.E * extent_variance.asDiagonal() * out.E.transpose();
  return out;
}

void TemperDepth(double sigmas, Linearized& outline) {
  const double excess = sigmas > 0.0 ? sigmas / kDeepSigmas : -sigmas / kNearSigmas;
  if (excess > 1.0) outline.R(0, 0) *= excess * excess;
}

}  // namespace v2vouch
