// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/bottom_edge.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace v2vouch {
namespace {

constexpr double kSearchShare = 0.12;    // Of the box's height, up and down.
constexpr double kLeastSearch_px = 2.0;  // The same at least.
constexpr double kSideShare = 0.1;       // Of the width left out at each side.
constexpr double kStandsOut = 2.0;       // Times the mean of all rows.
constexpr int kLeastColumns = 4;         // Narrower boxes are left as they are.

// Offset of a parabola's top through three neighbours, within half a row.
double TopOf(double before, double at, double after) {
  const double curve = before - 2.0 * at + after;
  return curve < 0.0 ? std::clamp(0.5 * (before - after) / curve, -0.5, 0.5) : 0.0;
}

}  // namespace

double BottomEdge(const cv::Mat& grey, const CameraBox& box) {
  const double bottom = box.top_px + box.height_px;
  const double search = std::max(kLeastSearch_px, kSearchShare * box.height_px);
  // A row more at both ends, for the neighbours of the best one.
  const int first = static_cast<int>(std::floor(bottom - search)) - 1;
  const int last = static_cast<int>(std::ceil(bottom + search)) + 1;
  const int left = static_cast<int>(std::lround(box.left_px + kSideShare * box.width_px));
  const int right = static_cast<int>(std::lround(box.left_px + (1.0 - kSideShare) * box.width_px));
  if (first < 1 || last > grey.rows - 2 || left < 0 || right > grey.cols ||
      right - left < kLeastColumns) {
    return bottom;
  }
  cv::Mat slope;
  cv::Sobel(grey(cv::Rect(left, first - 1, right - left, last - first + 3)), slope, CV_32F, 0, 1);
  std::vector<double> rows;  // Of rows first..last.
  for (int y = 1; y < slope.rows - 1; ++y) rows.push_back(cv::mean(slope.row(y))[0]);
  double sum = 0.0;
  std::size_t best = 1;
  for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
    sum += std::abs(rows[i]);
    if (rows[i] > rows[best]) best = i;
  }
  const double mean = sum / static_cast<double>(rows.size() - 2);
  if (!(rows[best] > kStandsOut * mean)) return bottom;
  // Row r covers r..r+1 in the coordinates of boxes; its middle is where the slope was taken.
  return first + static_cast<double>(best) + 0.5 +
         TopOf(rows[best - 1], rows[best], rows[best + 1]);
}

}  // namespace v2vouch
