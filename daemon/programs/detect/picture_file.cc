// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/detect/picture_file.h"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "daemon/common/data/object_class.h"
#include "daemon/rim/io/durable_file.h"

namespace v2vouch {
namespace {

constexpr std::uint64_t kNoiseSeed = 20240611;
constexpr double kDarkLight = 1.0 / 16.0;
constexpr double kDarkNoise = 4.0;
constexpr double kFlatContrast = 0.25;
constexpr double kNoisyNoise = 25.0;

cv::Mat WithNoise(const cv::Mat& bgr, double gain, double offset, double sigma) {
  cv::Mat values;
  bgr.convertTo(values, CV_32FC3, gain, offset);
  cv::Mat noise(bgr.size(), CV_32FC3);
  cv::RNG(kNoiseSeed).fill(noise, cv::RNG::NORMAL, 0.0, sigma);
  cv::Mat out;
  cv::Mat(values + noise).convertTo(out, CV_8UC3);
  return out;
}

// A light linear in exposure, then the camera's gamma of about 2.2: a sixteenth of the light.
double DarkGain() { return std::pow(kDarkLight, 1.0 / 2.2); }

cv::Scalar ColourOf(ObjectClass object_class) {
  switch (object_class) {
    case ObjectClass::kCar:
    case ObjectClass::kVan:
      return {80, 220, 80};
    case ObjectClass::kTruck:
    case ObjectClass::kBus:
      return {40, 160, 255};
    default:
      return {255, 120, 200};
  }
}

}  // namespace

cv::Mat ReadPicture(const std::string& path, std::string& error) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) {
    error = path + ": no such file";
    return {};
  }
  cv::Mat bgr;
  try {
    bgr = cv::imread(path, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {  // Larger than OpenCV will read.
  }
  if (bgr.empty()) error = path + ": is no picture that can be read";
  return bgr;
}

bool WriteAnnotated(const std::string& path, const cv::Mat& bgr,
                    const std::vector<CameraBox>& boxes, std::span<const std::string> inputs,
                    std::string& error) {
  cv::Mat canvas = bgr.clone();
  for (const CameraBox& box : boxes) {
    const cv::Rect2d frame(box.left_px, box.top_px, box.width_px, box.height_px);
    const cv::Scalar colour = ColourOf(box.object_class);
    cv::rectangle(canvas, frame, colour, 2);
    char label[64];
    std::snprintf(label, sizeof(label), "%s %.2f",
                  std::string(ObjectClassName(box.object_class)).c_str(), box.score);
    const cv::Point at(static_cast<int>(frame.x), std::max(12, static_cast<int>(frame.y) - 4));
    cv::putText(canvas, label, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, {0, 0, 0}, 3, cv::LINE_AA);
    cv::putText(canvas, label, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, colour, 1, cv::LINE_AA);
  }
  try {
    std::vector<std::uint8_t> png;
    cv::imencode(".png", canvas, png);
    return ReplaceFile(path, {reinterpret_cast<const char*>(png.data()), png.size()}, error,
                       inputs);
  } catch (const cv::Exception&) {
    error = path + ": cannot be made a PNG";
    return false;
  }
}

cv::Mat Degraded(const cv::Mat& bgr, const std::string& how) {
  if (how == "none") return bgr;
  if (how == "dark") return WithNoise(bgr, DarkGain(), 0.0, kDarkNoise);
  if (how == "flat") {
    const double mean = cv::mean(cv::mean(bgr))[0];
    return WithNoise(bgr, kFlatContrast, (1.0 - kFlatContrast) * mean, 1.0);
  }
  if (how == "noisy") return WithNoise(bgr, 1.0, 0.0, kNoisyNoise);
  return {};
}

}  // namespace v2vouch
