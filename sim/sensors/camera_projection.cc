// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/camera_projection.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::sim {
namespace {

Eigen::Vector2d Distorted(const CameraConfig& camera, double x, double y) {
  if (camera.distortion.empty()) return {x, y};
  const auto k = [&](std::size_t i) {
    return i < camera.distortion.size() ? camera.distortion[i] : 0.0;
  };
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k(0) + r2 * (k(1) + r2 * k(4)));
  return {x * radial + 2.0 * k(2) * x * y + k(3) * (r2 + 2.0 * x * x),
          y * radial + k(2) * (r2 + 2.0 * y * y) + 2.0 * k(3) * x * y};
}

}  // namespace

std::optional<Eigen::Vector2d> Project(const CameraConfig& camera, const Eigen::Vector3d& p_B,
                                       double extra_pitch_rad) {
  const Eigen::Vector3d d = p_B - Eigen::Vector3d(camera.x_m, camera.y_m, camera.z_m);
  const double cy = std::cos(camera.yaw_rad);
  const double sy = std::sin(camera.yaw_rad);
  const double ahead = cy * d.x() + sy * d.y();
  const double left = -sy * d.x() + cy * d.y();
  const double cp = std::cos(camera.pitch_rad + extra_pitch_rad);
  const double sp = std::sin(camera.pitch_rad + extra_pitch_rad);
  const double forward = cp * ahead - sp * d.z();
  const double up = sp * ahead + cp * d.z();
  const double cr = std::cos(camera.roll_rad);
  const double sr = std::sin(camera.roll_rad);
  const double right_C = cr * -left + sr * -up;  // Right side rolled down.
  const double down_C = cr * -up - sr * -left;
  if (forward < 0.2) return std::nullopt;
  const Eigen::Vector2d ray = Distorted(camera, right_C / forward, down_C / forward);
  return Eigen::Vector2d(camera.cx_px + camera.fx_px * ray.x(),
                         camera.cy_px + camera.fy_px * ray.y());
}

double HalfSpan(const CameraConfig& camera) {
  const double side = std::max(camera.cx_px, camera.image_width_px - camera.cx_px);
  return std::min(FromDegrees(85.0), std::atan(side / camera.fx_px) * 1.05);
}

}  // namespace v2vouch::sim
