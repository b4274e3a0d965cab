// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/common/data/input.h"
#include "daemon/common/data/measurement.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// Boxes -> angles in the levelled camera frame: score threshold, undistortion (OpenCV model,
/// inverted by fixed-point iteration), roll and pitch of the mount taken out (yaw stays: bearings
/// count from the camera's own axis), flags for edges that are the picture's border (within 2 px),
/// and for bottoms behind a nearer box (covered_bottom_share).
///
/// Left and right edge give their bearing at half the box's height, the bottom edge its depression
/// at half the box's width. Sigmas: edge_sigma_px through the lens at the same pixels; depression
/// with pitch_sigma added. Every class passes through, pedestrians and cyclists included.
///
/// A picture whose size differs from the configured one is taken as that picture scaled. Boxes that
/// are not finite, empty, wholly outside the picture or below min_score are skipped; the others are
/// cut to the picture. Order is kept; the content of `measurements` is replaced.
void ProcessCamera(const CameraDetections& detections, const CameraConfig& camera,
                   std::vector<CameraMeasurement>& measurements);

/// Bearing (left positive) and depression (down positive) of a pixel in the levelled camera frame.
///
///     (u, v) -> distorted ray (u - cx)/fx, (v - cy)/fy -> ray d_C by undistortion
///     d = R_y(pitch) R_x(roll) [d_z, -d_x, -d_y],  bearing = atan2(d_y, d_x),
///     depression = atan2(-d_z, |(d_x, d_y)|)
///
/// Distortion: k1 k2 p1 p2 k3; missing ones are 0. Where the model cannot be inverted (a pixel far
/// outside the lens's reach) the pinhole ray is used.
struct PixelAngles {
  double azimuth_rad = 0.0;
  double depression_rad = 0.0;
};
PixelAngles AnglesOfPixel(const CameraConfig& camera, double u_px, double v_px);

}  // namespace v2vouch
