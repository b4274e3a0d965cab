// SPDX-License-Identifier: Apache-2.0
#include "sim/world/mounting.h"

#include "daemon/common/base/did_you_mean.h"

namespace v2vouch::sim {
namespace {

RadarConfig* FindRadar(VehicleConfig& vehicle, const std::string& sensor) {
  for (RadarConfig& radar : vehicle.radars) {
    if (sensor == "radar_" + LowerCaseName(radar.name)) return &radar;
  }
  return nullptr;
}

CameraConfig* FindCamera(VehicleConfig& vehicle, const std::string& sensor) {
  for (CameraConfig& camera : vehicle.cameras) {
    if (sensor == "camera_" + LowerCaseName(camera.name)) return &camera;
  }
  return nullptr;
}

ObjectSensorConfig* FindObjects(VehicleConfig& vehicle, const std::string& sensor) {
  for (ObjectSensorConfig& source : vehicle.objects) {
    if (sensor == "objects_" + LowerCaseName(source.name)) return &source;
  }
  return nullptr;
}

template <class Flat>
void Move(const MountingErrorSpec& error, Flat& sensor) {
  sensor.x_m += error.x_m;
  sensor.y_m += error.y_m;
  sensor.yaw_rad += error.yaw_rad;
}

}  // namespace

VehicleConfig Mounted(const Scenario& scenario) {
  VehicleConfig vehicle = scenario.vehicle;
  for (const MountingErrorSpec& error : scenario.mounting) {
    if (RadarConfig* radar = FindRadar(vehicle, error.sensor)) {
      Move(error, *radar);
    } else if (ObjectSensorConfig* source = FindObjects(vehicle, error.sensor)) {
      Move(error, *source);
    } else if (CameraConfig* camera = FindCamera(vehicle, error.sensor)) {
      camera->x_m += error.x_m;
      camera->y_m += error.y_m;
      camera->z_m += error.z_m;
      camera->yaw_rad += error.yaw_rad;
      camera->pitch_rad += error.pitch_rad;
      camera->roll_rad += error.roll_rad;
    } else if (error.sensor == "antenna") {
      vehicle.antenna_x_m += error.x_m;
      vehicle.antenna_y_m += error.y_m;
    }
  }
  return vehicle;
}

void CheckMounting(const Scenario& scenario, std::vector<std::string>& problems) {
  VehicleConfig vehicle = scenario.vehicle;
  std::vector<std::string> names = {"antenna"};
  for (const auto& radar : vehicle.radars) names.push_back("radar_" + LowerCaseName(radar.name));
  for (const auto& camera : vehicle.cameras)
    names.push_back("camera_" + LowerCaseName(camera.name));
  for (const auto& source : vehicle.objects) {
    names.push_back("objects_" + LowerCaseName(source.name));
  }
  for (std::size_t i = 0; i < scenario.mounting.size(); ++i) {
    const MountingErrorSpec& error = scenario.mounting[i];
    const std::string who = "mounting[" + std::to_string(i) + "]";
    if (FindCamera(vehicle, error.sensor) != nullptr) continue;
    const bool is_flat = FindRadar(vehicle, error.sensor) != nullptr ||
                         FindObjects(vehicle, error.sensor) != nullptr;
    if (!is_flat && error.sensor != "antenna") {
      problems.push_back(who + ".sensor: '" + error.sensor +
                         "' is neither antenna nor a radar_<name>, camera_<name> or objects_<name> "
                         "of the vehicle" +
                         DidYouMean(error.sensor, names));
      continue;
    }
    if (error.z_m != 0.0 || error.pitch_rad != 0.0 || error.roll_rad != 0.0 ||
        (!is_flat && error.yaw_rad != 0.0)) {
      problems.push_back(who + ": " + error.sensor +
                         (is_flat ? " has x_m, y_m and yaw_deg only" : " has x_m and y_m only"));
    }
  }
}

}  // namespace v2vouch::sim
