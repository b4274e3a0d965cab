// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/result.h"
#include "daemon/common/data/camera_image.h"
#include "daemon/common/data/input.h"

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
