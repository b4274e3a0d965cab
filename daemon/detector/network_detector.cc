// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/network_detector.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "daemon/detector/bottom_edge.h"
#include "daemon/detector/picture.h"
#include "daemon/detector/tiles.h"
#include "daemon/detector/yolo_boxes.h"

namespace v2vouch {
namespace {

constexpr double kLeastSide_px = 2.0;  // Of a box inside the picture.

// Cut to the picture; what is left of it too small is nothing.
void CutTo(const cv::Size& picture, std::vector<CameraBox>& boxes) {
  for (CameraBox& box : boxes) {
    const double right = std::min<double>(picture.width, box.left_px + box.width_px);
    const double bottom = std::min<double>(picture.height, box.top_px + box.height_px);
    box.left_px = std::max(0.0, box.left_px);
    box.top_px = std::max(0.0, box.top_px);
    box.width_px = right - box.left_px;
    box.height_px = bottom - box.top_px;
  }
  std::erase_if(boxes, [](const CameraBox& box) {
    return !(box.width_px >= kLeastSide_px && box.height_px >= kLeastSide_px);
  });
}

}  // namespace

std::unique_ptr<NetworkDetector> NetworkDetector::Load(const DetectorConfig& config,
                                                       std::vector<std::string>& problems) {
  const std::size_t before = problems.size();
  if (config.input_width_px % 32 != 0 || config.input_height_px % 32 != 0) {
    problems.push_back(
        "detector.input_width_px, input_height_px = " + std::to_string(config.input_width_px) +
        ", " + std::to_string(config.input_height_px) + ": must be multiples of 32");
  }
  if (config.classes.empty()) problems.push_back("detector.classes: must name at least one class");
  if (problems.size() != before) return nullptr;
  auto network = Network::Load(config, problems);
  if (!network) return nullptr;
  return std::make_unique<NetworkDetector>(std::move(network), config);
}

NetworkDetector::NetworkDetector(std::unique_ptr<Network> network, const DetectorConfig& config)
    : network_(std::move(network)), config_(config) {}

Result<CameraDetections> NetworkDetector::Detect(const CameraImage& image) {
  const auto bgr = DecodePicture(image);
  if (!bgr) return bgr.reason();
  CameraDetections detections;
  static_cast<MessageHeader&>(detections) = image;
  detections.camera = image.camera;
  detections.image_width_px = image.width_px;
  detections.image_height_px = image.height_px;
  detections.boxes = Look(*bgr);
  return detections;
}

std::vector<CameraBox> NetworkDetector::Look(const cv::Mat& bgr) {
  const cv::Mat enhanced = Enhance(bgr, config_);
  const std::vector<Tile> tiles = TilesOf(enhanced.cols, config_.tiles, config_.tile_overlap);
  std::vector<std::vector<CameraBox>> seen;
  for (const Tile& tile : tiles) {
    auto boxes = network_->Look(enhanced(cv::Rect(tile.left_px, 0, tile.width_px, enhanced.rows)));
    for (CameraBox& box : boxes) box.left_px += tile.left_px;
    SuppressNonMaxima(config_.nms_iou, boxes);
    seen.push_back(std::move(boxes));
  }
  std::vector<CameraBox> boxes = MergeTiles(tiles, seen, enhanced.cols);
  CutTo(enhanced.size(), boxes);
  SuppressNonMaxima(config_.nms_iou, boxes);
  if (config_.refine_bottom) {
    cv::Mat grey;
    cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
    for (CameraBox& box : boxes) box.height_px = BottomEdge(grey, box) - box.top_px;
  }
  return boxes;
}

}  // namespace v2vouch
