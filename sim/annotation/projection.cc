// SPDX-License-Identifier: Apache-2.0
#include "sim/annotation/projection.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>

namespace v2vouch::sim {
namespace {

constexpr double kLeastDepth_m = 0.5;

Eigen::Vector2d Distorted(const std::vector<double>& coefficients, const Eigen::Vector2d& p) {
  std::array<double, 5> k{};
  std::copy_n(coefficients.begin(), std::min(coefficients.size(), k.size()), k.begin());
  const double r2 = p.squaredNorm();
  const double radial = 1.0 + k[0] * r2 + k[1] * r2 * r2 + k[4] * r2 * r2 * r2;
  const double xy = p.x() * p.y();
  return radial * p + Eigen::Vector2d(2.0 * k[2] * xy + k[3] * (r2 + 2.0 * p.x() * p.x()),
                                      k[2] * (r2 + 2.0 * p.y() * p.y()) + 2.0 * k[3] * xy);
}

}  // namespace

std::optional<Eigen::Vector2d> PixelOf(const CameraConfig& camera, const Eigen::Vector3d& p_B) {
  const Eigen::Vector3d seat(camera.x_m, camera.y_m, camera.z_m);
  const Eigen::Matrix3d R_BC = (Eigen::AngleAxisd(camera.yaw_rad, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(camera.pitch_rad, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(camera.roll_rad, Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  const Eigen::Vector3d d = R_BC.transpose() * (p_B - seat);
  if (!(d.x() > kLeastDepth_m)) return std::nullopt;
  const Eigen::Vector2d p = Distorted(camera.distortion, {-d.y() / d.x(), -d.z() / d.x()});
  return Eigen::Vector2d(camera.fx_px * p.x() + camera.cx_px, camera.fy_px * p.y() + camera.cy_px);
}

}  // namespace v2vouch::sim
