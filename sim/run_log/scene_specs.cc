// SPDX-License-Identifier: Apache-2.0
#include "sim/run_log/scene_specs.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch::evaluation {
namespace {

/// Sets `value` where the key exists and is a number.
void Read(const YAML::Node& node, const char* key, double& value) {
  if (node && node.IsMap() && node[key] && node[key].IsScalar()) {
    value = node[key].as<double>(value);
  }
}

void ReadDegrees(const YAML::Node& node, const char* key, double& value_rad) {
  double degrees = ToDegrees(value_rad);
  Read(node, key, degrees);
  value_rad = FromDegrees(degrees);
}

/// yaml-cpp's non-const operator[] would create what it does not find.
YAML::Node Child(const YAML::Node& node, const char* key) {
  if (!node || !node.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
  return node[key];
}

std::string NameOf(const YAML::Node& node, const std::string& fallback) {
  const YAML::Node name = Child(node, "name");
  return name && name.IsScalar() ? name.as<std::string>() : fallback;
}

SensorSpec FromRadar(const RadarConfig& radar, double noise_scale) {
  SensorSpec spec;
  spec.channel = "RADAR_" + radar.name;
  spec.x_m = radar.x_m;
  spec.y_m = radar.y_m;
  spec.yaw_rad = radar.yaw_rad;
  spec.half_fov_rad = radar.half_fov_rad;
  spec.max_range_m = radar.max_range_m;
  spec.period_s = radar.period_s;
  spec.range_sigma_m = noise_scale * radar.range_sigma_m;
  spec.azimuth_sigma_rad = noise_scale * radar.azimuth_sigma_rad;
  spec.range_rate_sigma_mps = noise_scale * radar.range_rate_sigma_mps;
  return spec;
}

SensorSpec FromCamera(const CameraConfig& camera, double noise_scale) {
  SensorSpec spec;
  spec.channel = "CAMERA_" + camera.name;
  spec.kind = SensorKind::kCamera;
  spec.x_m = camera.x_m;
  spec.y_m = camera.y_m;
  spec.z_m = camera.z_m;
  spec.yaw_rad = camera.yaw_rad;
  spec.half_fov_rad = std::atan2(0.5 * camera.image_width_px, camera.fx_px);
  spec.max_range_m = camera.max_range_m;
  spec.period_s = camera.period_s;
  // The middle of two edges.
  spec.azimuth_sigma_rad = noise_scale * camera.edge_sigma_px / camera.fx_px / std::sqrt(2.0);
  spec.depression_sigma_rad =
      noise_scale * std::hypot(camera.edge_sigma_px / camera.fy_px, camera.pitch_sigma_rad);
  return spec;
}

SensorSpec FromObjects(const ObjectSensorConfig& source, double noise_scale) {
  SensorSpec spec;
  spec.channel = "OBJECTS_" + source.name;
  spec.kind = SensorKind::kObjects;
  spec.x_m = source.x_m;
  spec.y_m = source.y_m;
  spec.yaw_rad = source.yaw_rad;
  spec.half_fov_rad = source.half_fov_rad;
  spec.max_range_m = source.max_range_m;
  spec.period_s = source.period_s;
  spec.position_sigma_m = noise_scale * source.position_sigma_m;
  return spec;
}

void ReadRadar(const YAML::Node& node, RadarConfig& radar) {
  radar.name = NameOf(node, radar.name);
  Read(node, "x_m", radar.x_m);
  Read(node, "y_m", radar.y_m);
  ReadDegrees(node, "yaw_deg", radar.yaw_rad);
  ReadDegrees(node, "half_fov_deg", radar.half_fov_rad);
  Read(node, "max_range_m", radar.max_range_m);
  Read(node, "period_s", radar.period_s);
  Read(node, "range_sigma_m", radar.range_sigma_m);
  ReadDegrees(node, "azimuth_sigma_deg", radar.azimuth_sigma_rad);
  Read(node, "range_rate_sigma_mps", radar.range_rate_sigma_mps);
}

void ReadCamera(const YAML::Node& node, CameraConfig& camera) {
  camera.name = NameOf(node, camera.name);
  Read(node, "x_m", camera.x_m);
  Read(node, "y_m", camera.y_m);
  Read(node, "z_m", camera.z_m);
  ReadDegrees(node, "yaw_deg", camera.yaw_rad);
  Read(node, "period_s", camera.period_s);
  Read(node, "fx_px", camera.fx_px);
  Read(node, "max_range_m", camera.max_range_m);
  double image_width_px = camera.image_width_px;
  Read(node, "image_width_px", image_width_px);
  camera.image_width_px = static_cast<int>(image_width_px);
  Read(node, "fy_px", camera.fy_px);
  Read(node, "edge_sigma_px", camera.edge_sigma_px);
  ReadDegrees(node, "pitch_sigma_deg", camera.pitch_sigma_rad);
}

void ReadObjects(const YAML::Node& node, ObjectSensorConfig& source) {
  source.name = NameOf(node, source.name);
  Read(node, "x_m", source.x_m);
  Read(node, "y_m", source.y_m);
  ReadDegrees(node, "yaw_deg", source.yaw_rad);
  ReadDegrees(node, "half_fov_deg", source.half_fov_rad);
  Read(node, "max_range_m", source.max_range_m);
  Read(node, "period_s", source.period_s);
  Read(node, "position_sigma_m", source.position_sigma_m);
}

void ReadVehicle(const YAML::Node& node, VehicleConfig& vehicle) {
  Read(node, "length_m", vehicle.length_m);
  Read(node, "width_m", vehicle.width_m);
  Read(node, "centre_x_m", vehicle.centre_x_m);
  if (const auto radars = Child(node, "radars"); radars && radars.IsSequence()) {
    vehicle.radars.assign(radars.size(), RadarConfig{});
    for (std::size_t i = 0; i < radars.size(); ++i) ReadRadar(radars[i], vehicle.radars[i]);
  }
  if (const auto cameras = Child(node, "cameras"); cameras && cameras.IsSequence()) {
    vehicle.cameras.assign(cameras.size(), CameraConfig{});
    for (std::size_t i = 0; i < cameras.size(); ++i) ReadCamera(cameras[i], vehicle.cameras[i]);
  }
  if (const auto objects = Child(node, "objects"); objects && objects.IsSequence()) {
    vehicle.objects.assign(objects.size(), ObjectSensorConfig{});
    for (std::size_t i = 0; i < objects.size(); ++i) ReadObjects(objects[i], vehicle.objects[i]);
  }
}

void ReadSender(const YAML::Node& bsm, SenderSpec& sender) {
  const YAML::Node gnss = Child(bsm, "gnss");
  Read(gnss, "bias_sigma_m", sender.bias_sigma_m);
  Read(gnss, "markov_sigma_m", sender.markov_sigma_m);
  Read(gnss, "markov_time_s", sender.markov_time_s);
  Read(gnss, "white_sigma_m", sender.white_sigma_m);
  Read(bsm, "speed_markov_mps", sender.speed_markov_mps);
  Read(bsm, "speed_white_mps", sender.speed_white_mps);
  ReadDegrees(bsm, "heading_markov_deg", sender.heading_markov_rad);
  ReadDegrees(bsm, "heading_white_deg", sender.heading_white_rad);
}

std::vector<Eigen::Vector2d> ReadOutline(const YAML::Node& building) {
  std::vector<Eigen::Vector2d> outline;
  if (const auto points = Child(building, "outline"); points && points.IsSequence()) {
    for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
      outline.emplace_back(points[i].as<double>(0.0), points[i + 1].as<double>(0.0));
    }
  }
  if (outline.size() >= 3) return outline;
  double x = 0.0, y = 0.0, yaw = 0.0, length = 20.0, width = 15.0;
  Read(building, "x_m", x);
  Read(building, "y_m", y);
  ReadDegrees(building, "yaw_deg", yaw);
  Read(building, "length_m", length);
  Read(building, "width_m", width);
  const Eigen::Vector2d along = Eigen::Vector2d(std::cos(yaw), std::sin(yaw)) * length / 2.0;
  const Eigen::Vector2d across = Eigen::Vector2d(-std::sin(yaw), std::cos(yaw)) * width / 2.0;
  const Eigen::Vector2d centre(x, y);
  return {centre + along + across, centre - along + across, centre - along - across,
          centre + along - across};
}

}  // namespace

bool SensorSpec::Covers(const Eigen::Vector2d& p_B) const {
  const Eigen::Vector2d line = p_B - Eigen::Vector2d(x_m, y_m);
  const double azimuth = WrapAngle(std::atan2(line.y(), line.x()) - yaw_rad);
  return line.norm() <= max_range_m && std::abs(azimuth) <= half_fov_rad;
}

int SceneSpecs::KindsThatCheck() const {
  const auto is_of_objects = [](const SensorSpec& s) { return s.kind == SensorKind::kObjects; };
  return !sensors.empty() && std::ranges::all_of(sensors, is_of_objects) ? 1 : 2;
}

SceneSpecs ReadSceneSpecs(const std::string& yaml) {
  SceneSpecs specs;
  VehicleConfig vehicle;
  double noise_scale = 1.0;
  try {
    const YAML::Node root = YAML::Load(yaml);
    specs.is_given = root.IsMap();
    specs.name = NameOf(root, "");
    const YAML::Node sensors = Child(root, "sensors");
    const YAML::Node mode = sensors && sensors.IsScalar() ? sensors : Child(sensors, "mode");
    specs.has_ideal_points = mode && mode.IsScalar() && mode.Scalar() == "ideal_points";
    Read(sensors, "noise_scale", noise_scale);
    ReadVehicle(Child(root, "vehicle"), vehicle);
    ReadSender(Child(root, "bsm"), specs.sender);
    if (const auto buildings = Child(root, "buildings"); buildings && buildings.IsSequence()) {
      for (const auto& building : buildings) specs.buildings.push_back(ReadOutline(building));
    }
  } catch (const YAML::Exception&) {
    specs.is_given = false;
  }
  specs.ego_length_m = vehicle.length_m;
  specs.ego_width_m = vehicle.width_m;
  specs.ego_centre_x_m = vehicle.centre_x_m;
  for (const auto& radar : vehicle.radars) specs.sensors.push_back(FromRadar(radar, noise_scale));
  for (const auto& camera : vehicle.cameras) {
    specs.sensors.push_back(FromCamera(camera, noise_scale));
  }
  for (const auto& source : vehicle.objects) {
    specs.sensors.push_back(FromObjects(source, noise_scale));
  }
  return specs;
}

}  // namespace v2vouch::evaluation
