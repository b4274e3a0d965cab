// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "daemon/common/data/input.h"

namespace v2vouch {

/// The picture at `path` (JPEG, PNG, ...), blue-green-red. Empty with `error` set where there is
/// none.
cv::Mat ReadPicture(const std::string& path, std::string& error);

/// A PNG file with `boxes` drawn in, class and score beside each. None of `inputs` is overwritten.
/// @return false with `error` set where it cannot be written.
bool WriteAnnotated(const std::string& path, const cv::Mat& bgr,
                    const std::vector<CameraBox>& boxes, std::span<const std::string> inputs,
                    std::string& error);

/// Copies of a picture as a camera would give them in worse light, the same every time:
///   dark   a sixteenth of the light, with the noise that brings (sigma 4 of 255)
///   flat   contrast cut to a quarter round the mean: fog, a misted windscreen
///   noisy  Gaussian noise, sigma 25 of 255
/// @return empty for any other name; the picture itself for "none".
cv::Mat Degraded(const cv::Mat& bgr, const std::string& how);

}  // namespace v2vouch
