// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calibration/extrinsics/chain_windows.h"

namespace v2vouch {

/// Where a vehicle stands in a picture [px]: the middle of its box's lower edge.
struct Foot {
  double u, v;
};

/// Feet of a picture's boxes; boxes that the picture's border cuts, and those below the camera's
/// least score, are left out.
std::vector<Foot> FeetOf(const CameraDetections& picture, const CameraConfig& camera);

/// Pixel of a window's target in a picture; nullopt where it is behind the camera.
/// @param mounting MountingParameters::Camera().
std::optional<Foot> Predicted(const TargetWindow& window, const LookPose& pose,
                              const CameraConfig& camera, const double* mounting);

/// Calls `visit(picture, index, windows around it)` for every picture of the camera that has any.
template <class Visit>
void ForEachPicture(const DriveLog& log, int camera, std::vector<TargetWindow>& windows,
                    const Visit& visit) {
  auto first = windows.begin();
  std::vector<TargetWindow*> open;
  for (std::size_t i = 0; i < log.pictures.size(); ++i) {
    const CameraDetections& picture = log.pictures[i];
    if (picture.camera != camera) continue;
    const std::int64_t number = ToMicros(picture.stamp) / kWindow_us;
    const auto number_of = [](const TargetWindow& w) { return ToMicros(w.middle) / kWindow_us; };
    while (first != windows.end() && number_of(*first) < number) ++first;
    open.clear();
    for (auto it = first; it != windows.end() && number_of(*it) == number; ++it) {
      open.push_back(&*it);
    }
    if (!open.empty()) visit(picture, i, open);
  }
}

}  // namespace v2vouch
