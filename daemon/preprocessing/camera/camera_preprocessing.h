// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/data/input.h"
#include "daemon/data/measurement.h"
#include "daemon/data/vehicle.h"

namespace v2vouch {

/// Boxes -> angles in the levelled camera frame: score threshold, undistortion (OpenCV model,
/// inverted by fixed-point iteration), roll, pitch and yaw of the mount taken out, flags for edges
/// that are the picture's border (within 2 px). Boxes that are not finite, empty or outside the
/// picture are skipped. Order is kept.
void ProcessCamera(const CameraDetections& detections, const CameraConfig& camera,
                   std::vector<CameraMeasurement>& measurements);

/// Bearing (left positive) and depression (down positive) of a pixel in the levelled camera frame.
struct PixelAngles {
  double azimuth_rad = 0.0;
  double depression_rad = 0.0;
};
PixelAngles AnglesOfPixel(const CameraConfig& camera, double u_px, double v_px);

}  // namespace v2vouch
