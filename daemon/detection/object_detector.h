// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/base/result.h"
#include "daemon/data/camera_image.h"
#include "daemon/data/input.h"

namespace v2vouch {

/// Finds vehicles and road users in a picture. Called from one thread.
class ObjectDetector {
 public:
  virtual ~ObjectDetector() = default;
  /// Detections carry the picture's own stamp, seq, camera and size; boxes lie inside the picture,
  /// strongest first. kBadImage where the picture cannot be read.
  virtual Result<CameraDetections> Detect(const CameraImage& image) = 0;
};

}  // namespace v2vouch
