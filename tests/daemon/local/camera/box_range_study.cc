// SPDX-License-Identifier: Apache-2.0
// How well a box's bottom edge tells the distance on real roads, and whether the predicted sigma
// says so: labelled boxes of KITTI tracking sequences through ProcessCamera, against the labels'
// 3-D boxes.
//
//   box_range_study PITCH_SIGMA_DEG LABELS...     a line of Markdown per label file and distance
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "daemon/local/camera/camera_preprocessing.h"
#include "sim/import/kitti.h"

namespace {

using namespace v2vouch;

// KITTI's colour camera of 2011-09-26, as in daemon/vehicles/vehicle_kitti.yaml.
CameraConfig KittiCameraConfig(double pitch_sigma_deg) {
  CameraConfig camera;
  camera.z_m = 1.65;
  camera.image_width_px = 1242;
  camera.image_height_px = 375;
  camera.fx_px = camera.fy_px = 721.5377;
  camera.cx_px = 609.5593;
  camera.cy_px = 172.854;
  camera.pitch_sigma_rad = FromDegrees(pitch_sigma_deg);
  return camera;
}

struct Sample {
  double range_m;        // Of the nearest corner along the camera's axis, from the label.
  double range_error_m;  // Of the one that the bottom edge tells.
  double normalised;     // Depression error over its predicted sigma.
  double range_sigma_m;  // Predicted: depression sigma through the flat road.
};

double NearestDepth(const sim::KittiLabel& label) {
  double nearest = 1e9;
  for (const double along : {0.5, -0.5}) {
    for (const double across : {0.5, -0.5}) {
      nearest =
          std::min(nearest, label.z_m - std::sin(label.rotation_y_rad) * along * label.length_m +
                                std::cos(label.rotation_y_rad) * across * label.width_m);
    }
  }
  return nearest;
}

std::vector<Sample> SamplesOf(const std::vector<sim::KittiLabel>& labels,
                              const CameraConfig& camera) {
  std::vector<Sample> samples;
  std::vector<CameraMeasurement> measured;
  for (const auto& label : labels) {
    const bool is_vehicle = label.type == "Car" || label.type == "Van" || label.type == "Truck";
    const double depth_m = NearestDepth(label);
    if (!is_vehicle || label.occluded != 0 || label.truncated > 0.0 || depth_m < 3.0) continue;
    CameraDetections detections;
    detections.image_width_px = camera.image_width_px;
    detections.image_height_px = camera.image_height_px;
    detections.boxes.push_back({label.left_px, label.top_px, label.right_px - label.left_px,
                                label.bottom_px - label.top_px, ObjectClass::kCar, 1.0});
    ProcessCamera(detections, camera, measured);
    if (measured.size() != 1 || measured[0].bottom_is_cut || measured[0].left_is_cut ||
        measured[0].right_is_cut) {
      continue;
    }
    const CameraMeasurement& m = measured[0];
    const double middle = 0.5 * (m.azimuth_left_rad + m.azimuth_right_rad);
    const double rise = camera.z_m * std::cos(middle);
    const double depression = std::atan2(rise, depth_m);
    if (!(m.depression_rad > 1e-3)) continue;  // At or over the horizon: no distance at all.
    const double told_m = rise / std::tan(m.depression_rad);
    samples.push_back({depth_m, told_m - depth_m,
                       (m.depression_rad - depression) / m.depression_sigma_rad,
                       m.depression_sigma_rad * (depth_m * depth_m + rise * rise) / rise});
  }
  return samples;
}

void Print(const char* path, double from_m, double to_m, const std::vector<Sample>& samples) {
  std::vector<double> amounts;
  double within_1 = 0.0;
  double within_2 = 0.0;
  double sigma = 0.0;
  for (const Sample& sample : samples) {
    if (sample.range_m < from_m || sample.range_m >= to_m) continue;
    amounts.push_back(std::abs(sample.range_error_m));
    within_1 += std::abs(sample.normalised) < 1.0 ? 1.0 : 0.0;
    within_2 += std::abs(sample.normalised) < 2.0 ? 1.0 : 0.0;
    sigma += sample.range_sigma_m;
  }
  if (amounts.size() < 10) return;
  std::sort(amounts.begin(), amounts.end());
  const auto n = static_cast<double>(amounts.size());
  std::printf("| %s | %.0f to %.0f m | %zu | %.2f | %.2f | %.2f | %.0f %% | %.0f %% |\n", path,
              from_m, to_m, amounts.size(), amounts[amounts.size() / 2],
              amounts[amounts.size() * 9 / 10], sigma / n, 100.0 * within_1 / n,
              100.0 * within_2 / n);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: box_range_study PITCH_SIGMA_DEG LABELS...\n");
    return 2;
  }
  const CameraConfig camera = KittiCameraConfig(std::atof(argv[1]));
  std::printf(
      "| labels | distance | boxes | median [m] | 90 %% [m] | predicted sigma [m] | within 1 "
      "sigma | within 2 |\n|---|---|---|---|---|---|---|---|\n");
  for (int i = 2; i < argc; ++i) {
    std::vector<sim::KittiLabel> labels;
    std::string error;
    if (!sim::ReadKittiLabels(argv[i], labels, error)) {
      std::fprintf(stderr, "box_range_study: %s\n", error.c_str());
      return 1;
    }
    const std::vector<Sample> samples = SamplesOf(labels, camera);
    std::string name(argv[i]);
    name = name.substr(name.rfind('/') + 1);
    for (const auto& [from_m, to_m] : {std::pair{5.0, 10.0},
                                       {10.0, 20.0},
                                       {20.0, 30.0},
                                       {30.0, 45.0},
                                       {45.0, 60.0},
                                       {5.0, 60.0}}) {
      Print(name.c_str(), from_m, to_m, samples);
    }
  }
  return 0;
}
