// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace v2vouch::bench {

/// Upright box in a level sensor frame: x forward, y left, z up.
struct Box3d {
  double x_m = 0.0;  ///< Of the bottom face's centre.
  double y_m = 0.0;
  double bottom_m = 0.0;  ///< Height of the bottom face.
  double yaw_rad = 0.0;   ///< Of its length, from x to the left.
  double length_m = 0.0;
  double width_m = 0.0;
  double height_m = 0.0;
};

/// Upright rectangle in a picture [px], y down.
struct PixelBox {
  double left = 0.0;
  double top = 0.0;
  double right = 0.0;
  double bottom = 0.0;
  [[nodiscard]] double height() const { return bottom - top; }
  [[nodiscard]] double area() const { return (right - left) * (bottom - top); }
};

/// Volume of both over volume of either, in [0, 1].
double Iou3d(const Box3d& a, const Box3d& b);

/// How much of `box` lies within `region`, in [0, 1]; 0 where the box has no area.
double CoveredShare(const PixelBox& box, const PixelBox& region);

}  // namespace v2vouch::bench
