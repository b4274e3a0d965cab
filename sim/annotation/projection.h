// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/data/vehicle.h"

namespace v2vouch::sim {

/// Where a point of the ego's body frame (x forward, y left, z up from the road) is in the picture.
///
///     d = R_x(-roll) R_y(-pitch) R_z(-yaw) (p - camera),  ideal = (-d_y, -d_z) / d_x,
///     pixel = f distorted(ideal) + c         (OpenCV's k1 k2 p1 p2 k3)
///
/// Written apart from the daemon's way back, so that each can be held against the other.
/// @return nullopt nearer than 0.5 m to the image plane, or behind it.
std::optional<Eigen::Vector2d> PixelOf(const CameraConfig& camera, const Eigen::Vector3d& p_B);

}  // namespace v2vouch::sim
