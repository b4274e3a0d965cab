// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "daemon/common/data/detector_config.h"
#include "daemon/detector/network.h"
#include "daemon/detector/object_detector.h"

namespace v2vouch {

/// Pictures to boxes: decode, enhance, tile, network, non-maximum suppression, bottom edge.
class NetworkDetector final : public ObjectDetector {
 public:
  /// @return nullptr with all problems named, see Network::Load; CheckDetector's among them.
  static std::unique_ptr<NetworkDetector> Load(const DetectorConfig& config,
                                               std::vector<std::string>& problems);
  NetworkDetector(std::unique_ptr<Network> network, const DetectorConfig& config);

  Result<CameraDetections> Detect(const CameraImage& image) override;
  /// The same for pixels (CV_8UC3). Boxes inside the picture, strongest first.
  std::vector<CameraBox> Look(const cv::Mat& bgr);

 private:
  std::unique_ptr<Network> network_;
  DetectorConfig config_;
};

}  // namespace v2vouch
