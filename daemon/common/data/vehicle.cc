// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/data/vehicle.h"

#include <algorithm>
#include <cctype>

namespace v2vouch {
namespace {

template <class Sensor>
const Sensor* At(const std::vector<Sensor>& sensors, int index) {
  const auto i = static_cast<std::size_t>(index);
  return index >= 0 && i < sensors.size() ? &sensors[i] : nullptr;
}

// Calls `of` with the sensor's own settings; `otherwise` where there is no such sensor.
template <class Value, class Of>
Value Ask(const VehicleConfig& vehicle, SensorKey sensor, Value otherwise, const Of& of) {
  const auto ask = [&](const auto* at) { return at == nullptr ? otherwise : of(*at); };
  switch (sensor.kind) {
    case SensorKind::kRadar:
      return ask(At(vehicle.radars, sensor.index));
    case SensorKind::kCamera:
      return ask(At(vehicle.cameras, sensor.index));
    case SensorKind::kObjects:
      return ask(At(vehicle.objects, sensor.index));
  }
  return otherwise;
}

}  // namespace

int VehicleConfig::SensorsOf(SensorKind kind) const {
  switch (kind) {
    case SensorKind::kRadar:
      return static_cast<int>(radars.size());
    case SensorKind::kCamera:
      return static_cast<int>(cameras.size());
    case SensorKind::kObjects:
      return static_cast<int>(objects.size());
  }
  return 0;
}

std::vector<SensorKey> VehicleConfig::AllSensors() const {
  std::vector<SensorKey> all;
  for (const SensorKind kind : kAllSensorKinds) {
    for (int i = 0; i < SensorsOf(kind); ++i) all.push_back({kind, i});
  }
  return all;
}

std::string VehicleConfig::NameOf(SensorKey sensor) const {
  return Ask(*this, sensor, std::string(), [](const auto& at) { return at.name; });
}

double VehicleConfig::PeriodOf(SensorKey sensor) const {
  return Ask(*this, sensor, 0.0, [](const auto& at) { return at.period_s; });
}

double VehicleConfig::DetectionProbabilityOf(SensorKey sensor) const {
  return Ask(*this, sensor, 0.0, [](const auto& at) { return at.detection_probability; });
}

std::string LowerCaseName(std::string name) {
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

std::vector<RadarConfig> VehicleConfig::DefaultRadars() {
  RadarConfig front;
  front.name = "FRONT";
  front.x_m = 3.75;
  front.half_fov_rad = FromDegrees(30.0);
  front.max_range_m = 160.0;
  front.azimuth_sigma_rad = FromDegrees(0.3);

  RadarConfig left;
  left.name = "FRONT_LEFT";
  left.x_m = 3.45;
  left.y_m = 0.75;
  left.yaw_rad = FromDegrees(55.0);
  left.half_fov_rad = FromDegrees(70.0);
  left.max_range_m = 80.0;
  left.azimuth_sigma_rad = FromDegrees(1.0);

  RadarConfig right = left;
  right.name = "FRONT_RIGHT";
  right.y_m = -0.75;
  right.yaw_rad = FromDegrees(-55.0);
  return {front, left, right};
}

}  // namespace v2vouch
