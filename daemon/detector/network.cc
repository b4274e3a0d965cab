// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/network.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>
#include <span>

#include "daemon/detector/darknet_cfg.h"
#include "daemon/detector/yolo_boxes.h"

namespace v2vouch {
namespace {

constexpr double kGrey = 114.0;  // What YOLOX was trained to see round a picture.

bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::span<const float> ValuesOf(const cv::Mat& blob) { return {blob.ptr<float>(), blob.total()}; }

// A picture made as large as the input, and the way back.
struct Fitted {
  cv::Mat picture;
  double scale_x = 1.0;  // Picture pixels per input pixel.
  double scale_y = 1.0;
};

Fitted Fit(const cv::Mat& bgr, const DetectorConfig& config) {
  const cv::Size input(config.input_width_px, config.input_height_px);
  Fitted fitted;
  fitted.scale_x = static_cast<double>(bgr.cols) / input.width;
  fitted.scale_y = static_cast<double>(bgr.rows) / input.height;
  if (config.fit == PictureFit::kStretch) {
    cv::resize(bgr, fitted.picture, input, 0.0, 0.0, cv::INTER_LINEAR);
    return fitted;
  }
  fitted.scale_x = fitted.scale_y = std::max(fitted.scale_x, fitted.scale_y);
  const cv::Size size(std::clamp(cvRound(bgr.cols / fitted.scale_x), 1, input.width),
                      std::clamp(cvRound(bgr.rows / fitted.scale_y), 1, input.height));
  fitted.picture = cv::Mat(input, CV_8UC3, cv::Scalar::all(kGrey));
  cv::Mat part = fitted.picture(cv::Rect(cv::Point(), size));
  cv::resize(bgr, part, size, 0.0, 0.0, cv::INTER_LINEAR);
  return fitted;
}

class DarknetNetwork final : public Network {
 public:
  DarknetNetwork(cv::dnn::Net net, const DetectorConfig& config)
      : net_(std::move(net)), config_(config), outputs_(net_.getUnconnectedOutLayersNames()) {}

  std::vector<CameraBox> Look(const cv::Mat& bgr) override {
    const Fitted fitted = Fit(bgr, config_);
    net_.setInput(cv::dnn::blobFromImage(fitted.picture, 1.0 / 255.0, {}, {}, true));
    std::vector<cv::Mat> blobs;
    net_.forward(blobs, outputs_);
    std::vector<CameraBox> boxes;
    for (const cv::Mat& blob : blobs) {
      CV_Assert(blob.type() == CV_32F && blob.dims == 2 && blob.cols > 5);
      AddDarknetBoxes({ValuesOf(blob), blob.cols},
                      {config_.input_width_px, config_.input_height_px}, config_, boxes);
    }
    ToPicture(fitted, boxes);
    return boxes;
  }

  static void ToPicture(const Fitted& fitted, std::vector<CameraBox>& boxes) {
    for (CameraBox& box : boxes) {
      box.left_px *= fitted.scale_x;
      box.width_px *= fitted.scale_x;
      box.top_px *= fitted.scale_y;
      box.height_px *= fitted.scale_y;
    }
  }

 private:
  cv::dnn::Net net_;
  DetectorConfig config_;
  std::vector<std::string> outputs_;
};

class YoloxNetwork final : public Network {
 public:
  YoloxNetwork(cv::dnn::Net net, const DetectorConfig& config)
      : net_(std::move(net)), config_(config) {}

  std::vector<CameraBox> Look(const cv::Mat& bgr) override {
    const Fitted fitted = Fit(bgr, config_);
    net_.setInput(cv::dnn::blobFromImage(fitted.picture));  // 0..255, blue first.
    const cv::Mat blob = net_.forward();
    CV_Assert(blob.type() == CV_32F && blob.dims == 3 && blob.size[0] == 1 && blob.size[2] > 5);
    std::vector<CameraBox> boxes;
    const bool is_yolox =
        AddYoloxBoxes({ValuesOf(blob), blob.size[2]},
                      {config_.input_width_px, config_.input_height_px}, config_, boxes);
    CV_Assert(is_yolox);
    DarknetNetwork::ToPicture(fitted, boxes);
    return boxes;
  }

 private:
  cv::dnn::Net net_;
  DetectorConfig config_;
};

std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool IsThere(const char* key, const std::string& path, std::vector<std::string>& problems) {
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error)) return true;
  problems.push_back(
      std::string("detector.") + key + ": " + path + ": no such file" +
      (EndsWith(path, ".weights") ? " (scripts/fetch_yolov4 gets the official ones)" : ""));
  return false;
}

std::unique_ptr<Network> LoadDarknet(const DetectorConfig& config,
                                     std::vector<std::string>& problems) {
  const std::string cfg =
      config.network.empty()
          ? std::filesystem::path(config.model).replace_extension(".cfg").string()
          : config.network;
  const bool has_model = IsThere("model", config.model, problems);
  if (!IsThere("network", cfg, problems) || !has_model) return nullptr;
  const auto expected = DarknetWeightBytes(ReadText(cfg));
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(config.model));
  if (expected && size != *expected) {
    problems.push_back("detector.model: " + config.model + ": has " + std::to_string(size) +
                       " bytes, but the layers of " + cfg + " need " + std::to_string(*expected));
    return nullptr;
  }
  return std::make_unique<DarknetNetwork>(cv::dnn::readNetFromDarknet(cfg, config.model), config);
}

}  // namespace

std::unique_ptr<Network> Network::Load(const DetectorConfig& config,
                                       std::vector<std::string>& problems) {
  // Both are the whole process's.
  cv::setNumThreads(config.threads);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // We say it ourselves.
  try {
    std::unique_ptr<Network> network;
    if (EndsWith(config.model, ".weights")) {
      network = LoadDarknet(config, problems);
    } else if (!EndsWith(config.model, ".onnx")) {
      problems.push_back("detector.model: " + config.model + ": must end in .weights or .onnx");
    } else if (IsThere("model", config.model, problems)) {
      network = std::make_unique<YoloxNetwork>(cv::dnn::readNetFromONNX(config.model), config);
    }
    if (network) {
      network->Look(
          cv::Mat(config.input_height_px, config.input_width_px, CV_8UC3, cv::Scalar::all(kGrey)));
    }
    return network;
  } catch (const std::exception& error) {
    problems.push_back("detector.model: " + config.model + ": cannot be used at " +
                       std::to_string(config.input_width_px) + " x " +
                       std::to_string(config.input_height_px) + ": " + error.what());
    return nullptr;
  }
}

}  // namespace v2vouch
