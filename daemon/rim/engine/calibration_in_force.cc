// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/calibration_in_force.h"

#include <algorithm>
#include <filesystem>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

std::string FileName(const DaemonConfig& config) {
  return std::filesystem::path(config.calibration).filename().string();
}

}  // namespace

wire::CalibrationInForce CalibrationInForce(const DaemonConfig& config) {
  wire::CalibrationInForce calibration;
  calibration.source = "configuration";
  const CalibrationFile* file = config.calibrated ? &*config.calibrated : nullptr;
  if (file != nullptr) {
    calibration.source = FileName(config);
    calibration.checksum = file->checksum;
  }
  const auto add = [&](const std::string& name, double value) {
    wire::CalibrationParameter parameter{name, value, kNaN,
                                         VerdictName(CalibrationVerdict::kPrior)};
    if (file != nullptr) {
      const auto at = std::ranges::find(file->parameters, name, &CalibratedParameter::name);
      if (at != file->parameters.end()) {
        parameter.verdict = VerdictName(at->verdict);
        parameter.std = IsApplied(at->verdict) ? at->std : at->prior_std;
      }
    }
    calibration.parameters.push_back(std::move(parameter));
  };
  const VehicleConfig& vehicle = config.perception.vehicle;
  for (const RadarConfig& radar : vehicle.radars) {
    const std::string sensor = "radar_" + LowerCaseName(radar.name);
    add(sensor + ".x_m", radar.x_m);
    add(sensor + ".y_m", radar.y_m);
    add(sensor + ".yaw_deg", ToDegrees(radar.yaw_rad));
    add(sensor + ".range_offset_m", radar.range_offset_m);
    add(sensor + ".clock_offset_s", radar.clock_offset_s);
  }
  for (const CameraConfig& camera : vehicle.cameras) {
    const std::string sensor = "camera_" + LowerCaseName(camera.name);
    add(sensor + ".x_m", camera.x_m);
    add(sensor + ".y_m", camera.y_m);
    add(sensor + ".z_m", camera.z_m);
    add(sensor + ".yaw_deg", ToDegrees(camera.yaw_rad));
    add(sensor + ".pitch_deg", ToDegrees(camera.pitch_rad));
    add(sensor + ".roll_deg", ToDegrees(camera.roll_rad));
    add(sensor + ".clock_offset_s", camera.clock_offset_s);
  }
  add("ego.antenna_x_m", vehicle.antenna_x_m);
  add("ego.antenna_y_m", vehicle.antenna_y_m);
  add("ego.heading_bias_deg", ToDegrees(vehicle.heading_bias_rad));
  add("ego.speed_scale", vehicle.speed_scale);
  add("ego.yaw_rate_bias_degps", ToDegrees(vehicle.yaw_rate_bias_radps));
  return calibration;
}

std::string CalibrationTitle(const DaemonConfig& config) {
  if (!config.calibrated) return "configuration";
  return FileName(config) + " " + config.calibrated->checksum.substr(0, 16);
}

int CountVerdicts(const DaemonConfig& config, CalibrationVerdict verdict) {
  if (!config.calibrated) return 0;
  return static_cast<int>(
      std::ranges::count(config.calibrated->parameters, verdict, &CalibratedParameter::verdict));
}

}  // namespace v2vouch
