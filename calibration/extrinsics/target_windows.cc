// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/target_windows.h"

#include <algorithm>
#include <cmath>

#include "calibration/extrinsics/box_feet.h"
#include "calibration/extrinsics/chain_windows.h"

namespace v2vouch {
namespace {

// For each window (by its place in `open`), the box of this picture that is its own.
void MatchBoxes(const CameraDetections& picture, std::size_t index, const EgoTrack& ego,
                const CameraConfig& camera, const double* mounting, double gate_rad,
                std::vector<TargetWindow*>& open) {
  const auto at = ego.At(picture.stamp);
  if (!at) return;
  struct Candidate {
    double nearest = 1e9, second = 1e9;
    std::size_t other = 0;
  };
  const std::vector<Foot> feet = FeetOf(picture, camera);
  std::vector<Candidate> of_window(open.size());
  std::vector<Candidate> of_box(feet.size());
  std::vector<LookPose> poses(open.size());
  const auto note = [](Candidate& candidate, double distance, std::size_t other) {
    if (distance < candidate.nearest) {
      candidate.second = candidate.nearest;
      candidate.nearest = distance;
      candidate.other = other;
    } else {
      candidate.second = std::min(candidate.second, distance);
    }
  };
  for (std::size_t i = 0; i < open.size(); ++i) {
    const TargetWindow& window = *open[i];
    const auto middle = ego.At(window.middle);
    const double dt_s = ToSeconds(picture.stamp - window.middle);
    poses[i] = PoseOf(*at, *middle, dt_s);
    const auto predicted = Predicted(window, poses[i], camera, mounting);
    if (!predicted) continue;
    for (std::size_t k = 0; k < feet.size(); ++k) {
      const double distance = std::hypot((feet[k].u - predicted->u) / camera.fx_px,
                                         (feet[k].v - predicted->v) / camera.fy_px);
      note(of_window[i], distance, k);
      note(of_box[k], distance, i);
    }
  }
  for (std::size_t i = 0; i < open.size(); ++i) {
    const Candidate& mine = of_window[i];
    if (mine.nearest > gate_rad || mine.second < 2.0 * mine.nearest) continue;
    const Candidate& its = of_box[mine.other];
    if (its.other != i || its.second < 2.0 * its.nearest) continue;
    open[i]->camera_looks.push_back(
        {picture.camera, index, poses[i], feet[mine.other].u, feet[mine.other].v});
  }
}

}  // namespace

std::vector<TargetWindow> PairTargets(const DriveLog& log, const EgoTrack& ego,
                                      const VehicleConfig& vehicle,
                                      const MountingParameters& parameters,
                                      const std::vector<RadarChain>& chains, double gate_rad) {
  std::vector<TargetWindow> windows = MakeWindows(ego, chains);
  for (int camera = 0; camera < parameters.cameras(); ++camera) {
    ForEachPicture(
        log, camera, windows, [&](const CameraDetections& picture, std::size_t index, auto& open) {
          MatchBoxes(picture, index, ego, vehicle.cameras[static_cast<std::size_t>(camera)],
                     parameters.Camera(camera), gate_rad, open);
        });
  }
  std::erase_if(windows, [](const TargetWindow& window) {
    const int radar = window.radar_looks.empty() ? 0 : window.radar_looks.front().radar;
    return window.camera_looks.empty() &&
           std::ranges::all_of(window.radar_looks,
                               [&](const auto& look) { return look.radar == radar; });
  });
  return windows;
}

}  // namespace v2vouch
