// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "daemon/common/data/input.h"

namespace v2vouch {

/// Where a vehicle meets the road: the row near the box's bottom at which the picture goes from
/// dark (tyres, shadow) to bright (road) most strongly, by the mean vertical Sobel response over
/// the middle 80 % of the box's width, to a fraction of a row. Searched within 12 % of the box's
/// height and at least 2 rows up and down.
/// @param grey CV_8UC1.
/// @return the box's own bottom where no row stands out (twice the mean response) or the box's
///   bottom is the picture's.
double BottomEdge(const cv::Mat& grey, const CameraBox& box);

}  // namespace v2vouch
