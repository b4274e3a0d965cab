// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/picture.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "daemon/detector/jpeg_frame.h"

namespace v2vouch {
namespace {

constexpr double kEdgeBlur_px = 2.0;

cv::Mat FromJpeg(const CameraImage& image) {
  const auto frame = ReadJpegFrame(image.bytes);
  if (!frame || frame->width_px != image.width_px || frame->height_px != image.height_px) return {};
  try {
    return cv::imdecode(image.bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {  // Tables missing or wrong.
    return {};
  }
}

cv::Mat FromRows(const CameraImage& image, int type) {
  const auto width = static_cast<std::size_t>(image.width_px);
  const auto height = static_cast<std::size_t>(image.height_px);
  if (image.bytes.size() != width * height * static_cast<std::size_t>(CV_MAT_CN(type))) return {};
  // OpenCV has no view of constant pixels; this one is only copied from.
  const cv::Mat view(image.height_px, image.width_px, type,
                     const_cast<std::uint8_t*>(image.bytes.data()));  // NOLINT
  if (type == CV_8UC3) return view.clone();
  cv::Mat bgr;
  cv::cvtColor(view, bgr, cv::COLOR_GRAY2BGR);
  return bgr;
}

}  // namespace

Result<cv::Mat> DecodePicture(const CameraImage& image) {
  if (image.width_px < 1 || image.height_px < 1) return Reason::kBadImage;
  cv::Mat bgr;
  switch (image.encoding) {
    case ImageEncoding::kJpeg:
      bgr = FromJpeg(image);
      break;
    case ImageEncoding::kMono8:
      bgr = FromRows(image, CV_8UC1);
      break;
    case ImageEncoding::kBgr8:
      bgr = FromRows(image, CV_8UC3);
      break;
  }
  if (bgr.cols != image.width_px || bgr.rows != image.height_px || bgr.type() != CV_8UC3) {
    return Reason::kBadImage;
  }
  return bgr;
}

cv::Mat Enhance(const cv::Mat& bgr, const DetectorConfig& config) {
  if (config.clahe_clip <= 0.0 && config.edge_gain <= 0.0) return bgr;
  cv::Mat lab;
  cv::cvtColor(bgr, lab, cv::COLOR_BGR2Lab);
  cv::Mat lightness;
  cv::extractChannel(lab, lightness, 0);
  if (config.clahe_clip > 0.0) {
    cv::createCLAHE(config.clahe_clip, {config.clahe_grid, config.clahe_grid})
        ->apply(lightness, lightness);
  }
  if (config.edge_gain > 0.0) {
    cv::Mat blurred;
    cv::GaussianBlur(lightness, blurred, {}, kEdgeBlur_px);
    cv::addWeighted(lightness, 1.0 + config.edge_gain, blurred, -config.edge_gain, 0.0, lightness);
  }
  cv::insertChannel(lightness, lab, 0);
  cv::Mat enhanced;
  cv::cvtColor(lab, enhanced, cv::COLOR_Lab2BGR);
  return enhanced;
}

}  // namespace v2vouch
