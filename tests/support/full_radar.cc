// SPDX-License-Identifier: Apache-2.0
#include "tests/support/full_radar.h"

#include <cmath>
#include <cstddef>
#include <variant>

#include "daemon/common/base/random.h"

namespace v2vouch::testing {

std::vector<Input> WithFullRadars(const SyntheticDrive& drive, FullKind kind, double from_s) {
  std::vector<Input> inputs = MakeInputs(drive);
  Random random = Random::ForSubject(drive.seed, 300);
  for (Input& input : inputs) {
    auto* scan = std::get_if<RadarScan>(&input);
    if (scan == nullptr || scan->stamp < DriveStart() + FromSeconds(from_s)) continue;
    const RadarConfig& radar = drive.vehicle.radars[static_cast<std::size_t>(scan->radar)];
    while (scan->detections.size() < static_cast<std::size_t>(kFullScan)) {
      RadarDetection detection;
      detection.range_m =
          kind == FullKind::kRing ? 30.0 : random.Uniform(radar.min_range_m, radar.max_range_m);
      detection.azimuth_rad = random.Uniform(-radar.half_fov_rad, radar.half_fov_rad);
      detection.range_rate_mps = random.Uniform(-30.0, 30.0);
      if (kind == FullKind::kStanding) {
        detection.range_rate_mps =
            -drive.ego_speed_mps * std::cos(detection.azimuth_rad + radar.yaw_rad);
      }
      detection.snr_db = 20.0;
      detection.rcs_dbsm = 10.0;
      scan->detections.push_back(detection);
    }
  }
  return inputs;
}

std::vector<Input> WithFullCameras(const SyntheticDrive& drive) {
  std::vector<Input> inputs = MakeInputs(drive);
  Random random = Random::ForSubject(drive.seed, 301);
  for (Input& input : inputs) {
    auto* picture = std::get_if<CameraDetections>(&input);
    if (picture == nullptr) continue;
    const CameraConfig& camera = drive.vehicle.cameras[static_cast<std::size_t>(picture->camera)];
    while (picture->boxes.size() < static_cast<std::size_t>(kFullFrame)) {
      const double width_px = random.Uniform(10.0, 200.0);
      const double height_px = random.Uniform(0.5, 1.2) * width_px;
      const double bottom_px = random.Uniform(camera.cy_px + 5.0, camera.image_height_px - 5.0);
      picture->boxes.push_back(
          {.left_px = random.Uniform(5.0, camera.image_width_px - width_px - 5.0),
           .top_px = bottom_px - height_px,
           .width_px = width_px,
           .height_px = height_px,
           .object_class = ObjectClass::kCar,
           .score = random.Uniform(0.3, 0.9)});
    }
  }
  return inputs;
}

}  // namespace v2vouch::testing
