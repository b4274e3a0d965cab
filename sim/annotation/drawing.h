// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "daemon/common/data/vehicle.h"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch::sim {

/// What is drawn into one picture; a null pointer is left out.
struct Scene {
  const camera_detections_t* boxes = nullptr;
  const track_list_t* local = nullptr;
  const track_list_t* priority = nullptr;
};

/// Draws in this order: boxes of the camera (thin, white, class and score), LOCAL (green boxes of
/// the estimated length and width standing on the road, id and distance), PRIORITY (magenta, a
/// size up, with `hidden` where no sensor sees the vehicle), and a line with the time on top.
/// Heights are those usual for the class: tracks have none.
/// @param picture CV_8UC3 of the camera's size; drawn into.
void DrawScene(const Scene& scene, const CameraConfig& camera, const std::string& title,
               cv::Mat& picture);

/// A picture for logs without any: dark, the horizon and the road's edges of a straight lane.
cv::Mat EmptyRoad(const CameraConfig& camera);

}  // namespace v2vouch::sim
