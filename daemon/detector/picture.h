// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "daemon/common/base/result.h"
#include "daemon/common/data/camera_image.h"
#include "daemon/common/data/detector_config.h"

namespace v2vouch {

/// The pixels of a received picture, blue-green-red, 8 bits. The file inside a JPEG is read for its
/// size first (jpeg_frame.h): one that is not whole, or not of the size the message tells, is
/// kBadImage and nothing was allocated for it. EXIF orientation is not followed: pixels are where
/// the intrinsics say.
Result<cv::Mat> DecodePicture(const CameraImage& image);

/// What the paper calls image preprocessing, on the brightness alone (L of Lab); colours stay.
/// In this order, each where its setting is above 0:
///   clahe_clip  contrast-limited adaptive histogram equalisation (Zuiderveld 1994), clahe_grid
///               cells per axis
///   edge_gain   edges added: L + edge_gain (L - Gaussian(L, sigma 2 px))
cv::Mat Enhance(const cv::Mat& bgr, const DetectorConfig& config);

}  // namespace v2vouch
