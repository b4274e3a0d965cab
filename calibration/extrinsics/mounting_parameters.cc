// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/mounting_parameters.h"

namespace v2vouch {
namespace {

constexpr double kDegrees = 180.0 / kPi;

}  // namespace

MountingParameters::MountingParameters(const VehicleConfig& vehicle, const MountingPriors& priors,
                                       bool knows_camera_places)
    : radars_(static_cast<int>(vehicle.radars.size())),
      cameras_(static_cast<int>(vehicle.cameras.size())) {
  std::string sensor;
  const auto add = [&](const char* quantity, double prior, double prior_std, double to_unit = 1.0,
                       bool is_anchor = false) {
    values_.push_back(prior);
    descriptions_.push_back(
        {sensor + "." + quantity, sensor, prior, prior_std, to_unit, is_anchor, false});
  };
  for (const RadarConfig& radar : vehicle.radars) {
    sensor = "radar_" + LowerCaseName(radar.name);
    add("x_m", radar.x_m, priors.place_m);
    add("y_m", radar.y_m, priors.place_m);
    add("yaw_deg", radar.yaw_rad, priors.angle_rad, kDegrees);
  }
  for (const CameraConfig& camera : vehicle.cameras) {
    sensor = "camera_" + LowerCaseName(camera.name);
    add("x_m", camera.x_m, priors.place_m);
    add("y_m", camera.y_m, priors.place_m);
    for (auto d = descriptions_.end() - 2; d != descriptions_.end(); ++d) {
      d->is_considered = !knows_camera_places;
    }
    add("z_m", camera.z_m, priors.place_m);
    add("yaw_deg", camera.yaw_rad, priors.angle_rad, kDegrees);
    add("pitch_deg", camera.pitch_rad, priors.angle_rad, kDegrees);
    add("roll_deg", camera.roll_rad, priors.angle_rad, kDegrees);
  }
  sensor = "ego";
  add("antenna_x_m", vehicle.antenna_x_m, priors.antenna_m);
  add("antenna_y_m", vehicle.antenna_y_m, priors.antenna_m);
  add("heading_bias_deg", vehicle.heading_bias_rad, priors.heading_bias_rad, kDegrees);
  add("speed_scale", vehicle.speed_scale, priors.speed_scale);
  add("yaw_rate_bias_degps", vehicle.yaw_rate_bias_radps, priors.yaw_rate_bias_radps, kDegrees);
  add("odometer_y_m", 0.0, priors.odometer_y_m, 1.0, true);
  add("slip_s2pm", 0.0, priors.slip_s2pm, 1.0, true);
}

}  // namespace v2vouch
