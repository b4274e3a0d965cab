// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/box_feet.h"

#include <cmath>

#include "calibration/extrinsics/camera_projection.h"

namespace v2vouch {
namespace {

constexpr double kBorder_px = 2.0;  // A box that comes nearer is cut by the picture's edge.

std::optional<Foot> FootOf(const CameraBox& box, const CameraDetections& picture) {
  const double right = box.left_px + box.width_px;
  const double bottom = box.top_px + box.height_px;
  if (box.left_px < kBorder_px || right > picture.image_width_px - kBorder_px ||
      bottom > picture.image_height_px - kBorder_px || box.top_px < kBorder_px) {
    return std::nullopt;
  }
  return Foot{0.5 * (box.left_px + right), bottom};
}

}  // namespace

std::optional<Foot> Predicted(const TargetWindow& window, const LookPose& pose,
                              const CameraConfig& camera, const double* mounting) {
  const double dx = window.state[0] + pose.dt_s * window.state[2] - pose.x_m;
  const double dy = window.state[1] + pose.dt_s * window.state[3] - pose.y_m;
  const double c = std::cos(pose.yaw_rad);
  const double s = std::sin(pose.yaw_rad);
  Foot foot{};
  if (!ProjectGround(camera, mounting, c * dx + s * dy, -s * dx + c * dy, 0.0, foot.u, foot.v)) {
    return std::nullopt;
  }
  return foot;
}

std::vector<Foot> FeetOf(const CameraDetections& picture, const CameraConfig& camera) {
  std::vector<Foot> feet;
  for (const CameraBox& box : picture.boxes) {
    if (box.score < camera.min_score) continue;
    if (const auto foot = FootOf(box, picture)) feet.push_back(*foot);
  }
  return feet;
}

}  // namespace v2vouch
