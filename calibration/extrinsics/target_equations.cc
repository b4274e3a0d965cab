// SPDX-License-Identifier: Apache-2.0
// What radars and cameras say of the same moving vehicles.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "calibration/extrinsics/drive_equations.h"

namespace v2vouch {
namespace {

// The direction a window's target moves in, against the ray from the ego to it.
Aspect AspectOf(const TargetWindow& window, const LookPose& pose) {
  const double ray = std::atan2(window.state[1] + pose.dt_s * window.state[3] - pose.y_m,
                                window.state[0] + pose.dt_s * window.state[2] - pose.x_m);
  const double aspect = std::atan2(window.state[3], window.state[2]) - ray;
  return {std::cos(aspect), std::cos(2.0 * aspect), std::sin(aspect), std::sin(2.0 * aspect)};
}

}  // namespace

void DriveEquations::AddTargets() {
  for (std::size_t i = 0; i < data.windows.size(); ++i) {
    const TargetWindow& window = data.windows[i];
    auto& target = targets[i];
    std::copy(std::begin(window.state), std::end(window.state), target.begin());
    blocks.push_back(target.data());
    for (const auto& look : window.radar_looks) AddRadarTarget(window, look, target.data());
    for (const auto& look : window.camera_looks) AddCameraTarget(window, look, target.data());
  }
}

void DriveEquations::AddRadarTarget(const TargetWindow& window, const TargetWindow::RadarLook& look,
                                    double* target) {
  const double time_s = SecondsOf(window.middle);
  const RadarConfig& radar = data.vehicle->radars[static_cast<std::size_t>(look.radar)];
  const int range_group = Group(RadarName(look.radar) + ".target_range");
  const int azimuth_group = Group(RadarName(look.radar) + ".target_azimuth");
  const double across_m = options.wander_m;
  const Aspect aspect = AspectOf(window, look.pose);
  const RadarTargetCost range{.pose = look.pose,
                              .measured = look.range_m,
                              .sigma = std::hypot(radar.range_sigma_m, across_m),
                              .is_azimuth = false,
                              .aspect = aspect,
                              .range_m = look.range_m,
                              .sin_azimuth = std::sin(look.azimuth_rad),
                              .radar_x_m = parameters.Radar(look.radar)[0],
                              .radar_y_m = parameters.Radar(look.radar)[1]};
  RadarTargetCost azimuth = range;
  azimuth.measured = look.azimuth_rad;
  azimuth.sigma = std::hypot(radar.azimuth_sigma_rad, across_m / std::max(1.0, look.range_m));
  azimuth.is_azimuth = true;
  constexpr int kR = MountingParameters::kPerRadar;
  if (options.offset_m <= 0.0) {
    Add(AutoDiff<RadarTargetCost, kR, 4>(range), &cauchy, range_group, time_s,
        parameters.Radar(look.radar), target);
    Add(AutoDiff<RadarTargetCost, kR, 4>(azimuth), &cauchy, azimuth_group, time_s,
        parameters.Radar(look.radar), target);
    return;
  }
  auto& offset = offsets[look.chain];
  if (!offset) {
    offset = {0.0, 0.0};
    blocks.push_back(offset->data());
    for (int k = 0; k < 2; ++k) {
      Add(AutoDiff<PriorCost, 2>({k, 0.0, options.offset_m}), nullptr,
          k == 0 ? range_group : azimuth_group, time_s, offset->data());
    }
  }
  double* const of_all = Shape(time_s);
  double* const of_radar = Lean(look.radar, time_s);
  Add(AutoDiff<RadarTargetCost, kR, 4, 2, kShape, kLean>(range), &cauchy, range_group, time_s,
      parameters.Radar(look.radar), target, offset->data(), of_all, of_radar);
  Add(AutoDiff<RadarTargetCost, kR, 4, 2, kShape, kLean>(azimuth), &cauchy, azimuth_group, time_s,
      parameters.Radar(look.radar), target, offset->data(), of_all, of_radar);
}

void DriveEquations::AddCameraTarget(const TargetWindow& window,
                                     const TargetWindow::CameraLook& look, double* target) {
  const double time_s = SecondsOf(window.middle);
  const CameraConfig& camera = data.vehicle->cameras[static_cast<std::size_t>(look.camera)];
  auto& nod = nods[look.picture];
  if (!nod) {
    nod = 0.0;
    blocks.push_back(&*nod);
    Add(AutoDiff<PriorCost, 1>({0, 0.0, camera.pitch_sigma_rad}), nullptr,
        Group(CameraName(look.camera) + ".nod"), time_s, &*nod);
  }
  for (const bool is_row : {false, true}) {
    Add(AutoDiff<BoxCost, MountingParameters::kPerCamera, 4, 1>(
            {&camera, look.pose, is_row ? look.v_px : look.u_px, camera.edge_sigma_px, is_row}),
        &cauchy, Group(CameraName(look.camera) + (is_row ? ".box_row" : ".box_column")), time_s,
        parameters.Camera(look.camera), target, &*nod);
  }
}

}  // namespace v2vouch
