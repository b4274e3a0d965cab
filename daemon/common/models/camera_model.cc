// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <span>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/dual.h"
#include "daemon/common/models/measurement_model.h"

namespace v2vouch {
namespace {

constexpr double kMinDepth_m = 0.3;  // Nearer to the image plane nothing is projected.
constexpr double kPoint_m = 1e-3;    // A smaller vehicle is a point.
// Bodies are rounded: a silhouette ends this far (1 sigma) from the corner of the box.
constexpr double kCornerSigma_m = 0.08;
// The box's bottom touches tyre or bumper, not the footprint's edge.
constexpr double kContactSigma_m = 0.2;
// Edges miss a silhouette by a share of its width, and stay wrong for some tenths of a second, as
// the car's pitch does: so many pictures tell as much as one with white noise.
constexpr double kWidthShare = 0.02;
constexpr double kLooksAsOne = 9.0;
constexpr double kPitchLooks = 3.0;
// An edge whose partner is cut by the picture's border is trusted this much less.
constexpr double kLoneEdgeFactor = 2.0;

using D = Dual<kStateSize + 2>;

// One row: value, derivatives by state and extent, and variance.
struct Row {
  double innovation;
  D prediction;
  double variance;
};

// Bearings of the silhouette's edges and distance of its nearest point along the axis, axes of C.
struct Silhouette {
  D left, right, depth;
};

// nullopt when a part of the vehicle is beside or behind the camera.
std::optional<Silhouette> SilhouetteOf(const D& centre_x, const D& centre_y, const D& yaw,
                                       const Extent& extent, bool is_point) {
  D left = atan2(centre_y, centre_x);
  D right = left;
  D depth = centre_x;
  if (!(centre_x.value > kMinDepth_m)) return std::nullopt;
  if (!is_point) {
    const D half_length = 0.5 * D::Variable(extent.length_m, kStateSize);
    const D half_width = 0.5 * D::Variable(extent.width_m, kStateSize + 1);
    const D c = cos(yaw);
    const D s = sin(yaw);
    bool is_first = true;
    for (const double along : {1.0, -1.0}) {
      for (const double across : {1.0, -1.0}) {
        const D corner_x = centre_x + along * (c * half_length) - across * (s * half_width);
        const D corner_y = centre_y + along * (s * half_length) + across * (c * half_width);
        if (!(corner_x.value > kMinDepth_m)) return std::nullopt;
        const D bearing = atan2(corner_y, corner_x);
        if (is_first || bearing.value > left.value) left = bearing;
        if (is_first || bearing.value < right.value) right = bearing;
        if (is_first || corner_x.value < depth.value) depth = corner_x;
        is_first = false;
      }
    }
  }
  return Silhouette{left, right, depth};
}

Linearized Stack(std::span<const Row> rows, const Extent& extent) {
  Linearized out;
  const auto size = static_cast<Eigen::Index>(rows.size());
  out.y.resize(size);
  out.H.resize(size, Eigen::NoChange);
  out.E.resize(size, Eigen::NoChange);
  out.R.setZero(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    out.y[i] = row.innovation;
    out.H.row(i) = row.prediction.gradient.head<kStateSize>();
    out.E.row(i) = row.prediction.gradient.tail<2>();
    out.R(i, i) = row.variance;
  }
  const Eigen::Vector2d extent_variance(extent.length_sigma_m * extent.length_sigma_m,
                                        extent.width_sigma_m * extent.width_sigma_m);
  out.R += out.E * extent_variance.asDiagonal() * out.E.transpose();
  return out;
}

}  // namespace

std::optional<Linearized> LinearizeCamera(const StateVector& x, const Extent& extent,
                                          const EgoState& ego, const CameraConfig& camera,
                                          const CameraMeasurement& measurement) {
  const Pose<Odometry, Camera> X_OC =
      ego.X_OB * Pose<Body, Camera>(camera.x_m, camera.y_m, camera.yaw_rad);
  const double cos_c = std::cos(X_OC.yaw_rad());
  const double sin_c = std::sin(X_OC.yaw_rad());
  const D px = D::Variable(x[kX] - X_OC.x_m(), kX);
  const D py = D::Variable(x[kY] - X_OC.y_m(), kY);
  const D yaw = D::Variable(x[kYaw] - X_OC.yaw_rad(), kYaw);
  const D centre_x = cos_c * px + sin_c * py;
  const D centre_y = cos_c * py - sin_c * px;

  const bool is_point = extent.length_m < kPoint_m || extent.width_m < kPoint_m;
  const auto silhouette = SilhouetteOf(centre_x, centre_y, yaw, extent, is_point);
  if (!silhouette) return std::nullopt;
  const auto& [left, right, depth] = *silhouette;

  std::array<Row, 3> rows;
  std::size_t count = 0;
  const double distance = std::hypot(centre_x.value, centre_y.value);
  const double corner = is_point ? 0.0 : kCornerSigma_m / distance;
  const double share =
      is_point ? 0.0 : kWidthShare * (measurement.azimuth_left_rad - measurement.azimuth_right_rad);
  const double looks = is_point ? 1.0 : kLooksAsOne;
  const double edge = looks * (measurement.azimuth_sigma_rad * measurement.azimuth_sigma_rad +
                               share * share + corner * corner);
  const bool has_left = !measurement.left_is_cut;
  const bool has_right = !measurement.right_is_cut;
  const double middle = 0.5 * (measurement.azimuth_left_rad + measurement.azimuth_right_rad);
  if (is_point) {
    if (has_left && has_right) {
      rows[count++] = {WrapAngle(middle - left.value), left, 0.5 * edge};
    }
  } else {
    const double factor = has_left && has_right ? 1.0 : kLoneEdgeFactor * kLoneEdgeFactor;
    if (has_left) {
      rows[count++] = {WrapAngle(measurement.azimuth_left_rad - left.value), left, factor * edge};
    }
    if (has_right) {
      rows[count++] = {WrapAngle(measurement.azimuth_right_rad - right.value), right,
                       factor * edge};
    }
  }
  if (!measurement.bottom_is_cut) {
    const D rise(camera.z_m * std::cos(middle));
    const D depression = atan2(rise, depth);
    const double contact = is_point ? 0.0 : depression.value * kContactSigma_m / depth.value;
    rows[count++] = {measurement.depression_rad - depression.value, depression,
                     (is_point ? 1.0 : kPitchLooks) *
                             (measurement.depression_sigma_rad * measurement.depression_sigma_rad) +
                         contact * contact};
  }
  if (count == 0) return std::nullopt;
  return Stack(std::span(rows).first(count), extent);
}

}  // namespace v2vouch
