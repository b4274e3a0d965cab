// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "daemon/common/data/detector_config.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// A YOLO network on the CPU: YOLOv4, YOLOv4-tiny, Yolo-Fastest (darknet .cfg and .weights) or
/// YOLOX (.onnx). The file's ending says which.
class Network {
 public:
  /// Reads the files and looks at one grey picture, so that whatever does not fit comes out now.
  /// @return nullptr with `problems` naming key, file and fault: absent, of the wrong size for its
  ///   .cfg, no network, output of another shape.
  static std::unique_ptr<Network> Load(const DetectorConfig& config,
                                       std::vector<std::string>& problems);
  virtual ~Network() = default;

  /// Boxes in pixels of `bgr` (CV_8UC3), one vehicle perhaps several times. Throws cv::Exception
  /// where OpenCV does.
  virtual std::vector<CameraBox> Look(const cv::Mat& bgr) = 0;
};

}  // namespace v2vouch
