// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/data/vehicle.h"

namespace v2vouch::sim {

/// Pixel of a point given in the body frame (x forward, y left, z up from the road), through
/// mounting, pinhole and OpenCV distortion. `extra_pitch_rad` is the body's nod, down positive.
/// @return nullopt for points less than 0.2 m ahead of the image plane.
std::optional<Eigen::Vector2d> Project(const CameraConfig& camera, const Eigen::Vector3d& p_B,
                                       double extra_pitch_rad = 0.0);

/// Half of the span the rays must cover: the picture's wider side, and a margin.
double HalfSpan(const CameraConfig& camera);

}  // namespace v2vouch::sim
