// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/daemon_config.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/config/yaml_writer.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/input_decoder.h"

namespace v2vouch {
namespace {

bool IsChannelName(const std::string& name) {
  const auto is_plain = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.' || c == '/';
  };
  return !name.empty() && name.size() <= kMaxChannelLength &&
         std::all_of(name.begin(), name.end(), is_plain);
}

constexpr std::size_t kMaxIdLength = 64;

bool IsVehicleId(const std::string& id) {
  return id.size() <= kMaxIdLength &&
         std::all_of(id.begin(), id.end(), [](char c) { return c >= 0x20 && c < 0x7F; });
}

class Checks {
 public:
  Checks(const std::string& name, std::vector<std::string>& problems)
      : name_(name), problems_(problems) {}

  void Channel(const std::string& key, const std::string& channel) {
    if (!IsChannelName(channel)) {
      Problem(key, "channel \"" + channel.substr(0, 80) +
                       "\": must have 1 to 63 letters, digits, or _ - . /");
      return;
    }
    const auto [entry, is_new] = channels_.emplace(channel, key);
    if (!is_new) Problem(key, "channel " + channel + ": is that of " + entry->second + " already");
  }

  void Problem(const std::string& key, const std::string& what) {
    problems_.push_back(name_ + ": " + key + ": " + what);
  }

 private:
  const std::string& name_;
  std::vector<std::string>& problems_;
  std::map<std::string, std::string> channels_;
};

// Calibrations spell sensors in lower case: "Front" and "FRONT" would share one entry.
template <class Sensor>
void CheckSensors(const std::string& list, const std::vector<Sensor>& sensors, Checks& checks) {
  if (sensors.size() > static_cast<std::size_t>(kMostSensorsOfAKind)) {
    checks.Problem(list, "must be at most " + std::to_string(kMostSensorsOfAKind));
  }
  std::map<std::string, std::string> names;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const auto [entry, is_new] = names.emplace(LowerCaseName(sensors[i].name), sensors[i].name);
    if (is_new || entry->second == sensors[i].name) continue;  // Equal ones share a channel.
    checks.Problem(list + "[" + std::to_string(i) + "].name",
                   sensors[i].name + ": differs from " + entry->second + " by its case only");
  }
}

std::string KeyOf(const wire::InputChannel& channel) {
  const std::string index = "[" + std::to_string(channel.sensor) + "].name";
  switch (channel.kind) {
    case wire::InputKind::kRadar:
      return "vehicle.radars" + index;
    case wire::InputKind::kCameraBoxes:
    case wire::InputKind::kCameraImage:
      return "vehicle.cameras" + index;
    case wire::InputKind::kObjects:
      return "vehicle.objects" + index;
    case wire::InputKind::kEgoMotion:
      return "lcm.channels.ego_motion";
    case wire::InputKind::kGnss:
      return "lcm.channels.ego_gnss";
    case wire::InputKind::kBsm:
      return "lcm.channels.bsm";
    case wire::InputKind::kOwnBsm:
      break;
  }
  return "lcm.channels.own_bsm";
}

// An empty file, or one of comments only: what a full disk or a broken edit leaves behind.
bool HoldsNothing(const std::string& path) {
  std::vector<std::string> problems;
  const auto text = config::ReadFile(path, problems);
  const auto root = text ? config::ParseYaml(*text, path, problems) : std::nullopt;
  return root && root->type == config::YamlNode::Type::kEmpty;
}

void CheckChannels(const DaemonConfig& config, Checks& checks) {
  const VehicleConfig& vehicle = config.perception.vehicle;
  const wire::ChannelNames& names = config.lcm.channels;
  for (const auto& channel : wire::InputChannels(vehicle, names)) {
    checks.Channel(KeyOf(channel), channel.name);
  }
  for (std::size_t i = 0; i < vehicle.cameras.size(); ++i) {
    if (vehicle.cameras[i].source != CameraSource::kImage) continue;
    checks.Channel("vehicle.cameras[" + std::to_string(i) + "].name",
                   wire::DetectedChannel(names, vehicle.cameras[i]));
  }
  checks.Channel("lcm.channels.tracks_local", names.tracks_local);
  checks.Channel("lcm.channels.tracks_priority", names.tracks_priority);
  checks.Channel("lcm.channels.tracks_v2v", names.tracks_v2v);
  checks.Channel("lcm.channels.calibration", names.calibration);
  checks.Channel("lcm.channels.misbehavior", names.misbehavior);
  checks.Channel("lcm.channels.bsm_verdict", names.bsm_verdict);
  checks.Channel("lcm.channels.status", names.status);
  checks.Channel("lcm.channels.config", names.config);
}

template <class Sensor>
void CheckRanges(const std::string& list, const std::vector<Sensor>& sensors, Checks& checks) {
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (sensors[i].min_range_m >= sensors[i].max_range_m) {
      checks.Problem(list + "[" + std::to_string(i) + "].min_range_m", "must be below max_range_m");
    }
  }
}

void CheckVehicle(const VehicleConfig& vehicle, Checks& checks) {
  if (!IsVehicleId(vehicle.id)) {
    checks.Problem("vehicle.id", "must have at most 64 printable ASCII characters");
  }
  CheckSensors("vehicle.radars", vehicle.radars, checks);
  CheckSensors("vehicle.cameras", vehicle.cameras, checks);
  CheckSensors("vehicle.objects", vehicle.objects, checks);
  CheckRanges("vehicle.objects", vehicle.objects, checks);
  CheckRanges("vehicle.radars", vehicle.radars, checks);
  for (std::size_t i = 0; i < vehicle.cameras.size(); ++i) {
    const std::size_t count = vehicle.cameras[i].distortion.size();
    if (count != 0 && count != 4 && count != 5) {
      checks.Problem("vehicle.cameras[" + std::to_string(i) + "].distortion",
                     "must hold k1, k2, p1, p2 and perhaps k3, or nothing");
    }
  }
}

}  // namespace

void CheckConfig(const DaemonConfig& config, const std::string& name,
                 std::vector<std::string>& problems) {
  Checks checks(name, problems);
  CheckChannels(config, checks);
  CheckVehicle(config.perception.vehicle, checks);
  const IntakeConfig& v2v = config.perception.v2v;
  if (v2v.min_position_sigma_m > v2v.max_position_sigma_m) {
    checks.Problem("v2v.min_position_sigma_m", "must be at most max_position_sigma_m");
  }
  if (v2v.max_position_sigma_m > v2v.usable_position_sigma_m) {
    checks.Problem("v2v.max_position_sigma_m", "must be at most usable_position_sigma_m");
  }
  const double settled_s =
      config.perception.timeline.replay_buffer_s + config.perception.timeline.future_s;
  if (config.gps_bias.estimate_age_s < settled_s) {
    checks.Problem("gps_bias.estimate_age_s",
                   "must be at least timeline.replay_buffer_s + future_s");
  }
}

bool LoadDaemonConfig(const std::string& path, DaemonConfig& config,
                      std::vector<std::string>& problems, std::vector<std::string>* notes) {
  if (!path.empty()) {
    const DetectorConfig before = config.detector;
    const std::string state_before = config.state.file;
    config::Load(path, config, problems, notes);
    if (notes != nullptr && HoldsNothing(path)) {
      notes->push_back(path + ": holds no setting, so this is the shipped vehicle");
    }
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    const auto beside = [&](std::string& file, const std::string& old) {
      if (!file.empty() && file != old) file = (folder / file).string();
    };
    beside(config.detector.model, before.model);
    beside(config.detector.network, before.network);
    beside(config.state.file, state_before);
  }
  CheckConfig(config, path.empty() ? "built-in configuration" : path, problems);
  config.calibrated.reset();
  if (!config.calibration.empty()) {
    const auto file = std::filesystem::path(path).parent_path() / config.calibration;
    config.calibrated = LoadCalibration(file.string(), problems);
    if (problems.empty()) {
      ApplyCalibration(*config.calibrated, config.perception.vehicle, problems);
      for (std::string& problem : problems) problem.insert(0, file.string() + ": ");
    }
  }
  return problems.empty();
}

void MakeAbsolute(const std::string& path, DaemonConfig& config) {
  if (!config.calibration.empty()) {
    const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
    config.calibration = (folder / config.calibration).lexically_normal().string();
  }
  for (std::string* file : {&config.detector.model, &config.detector.network}) {
    if (!file->empty()) *file = std::filesystem::absolute(*file).lexically_normal().string();
  }
}

std::string PrintDaemonConfig(const DaemonConfig& config) { return config::Print(config); }

std::vector<config::Key> DaemonConfigKeys() { return config::KeysOf(DaemonConfig{}); }

}  // namespace v2vouch
