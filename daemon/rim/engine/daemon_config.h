// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/common/base/visit.h"
#include "daemon/common/data/detector_config.h"
#include "daemon/local/mount_monitor/mount_monitor_config.h"
#include "daemon/pipeline/perception_config.h"
#include "daemon/rim/calibration_file/calibration_file.h"
#include "daemon/rim/config/key_list.h"
#include "daemon/rim/wire/channels.h"
#include "daemon/v2v/gps_bias/gps_bias_config.h"

namespace v2vouch {

/// How the daemon talks. Replay uses the channel names only.
struct LcmConfig {
  std::string url;       ///< "" = the environment's LCM_DEFAULT_URL, else LCM's own default.
  std::string v2v_url;   ///< A port of its own for BSMs (recommended); "" = the same as `url`.
  int own_queue = 256;   ///< Messages of own sensors that may wait; the oldest is dropped.
  int bsm_queue = 4096;  ///< The same for BSMs.
  wire::ChannelNames channels;

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("url", url);
    a.Text("v2v_url", v2v_url);
    a.Field("own_queue", own_queue, {.at_least = 8, .at_most = 65536});
    a.Field("bsm_queue", bsm_queue, {.at_least = 8, .at_most = 65536});
    a.Field("channels", channels);
  }
};

/// What the daemon keeps over a restart: penalties of senders, and which were validated. Tracks
/// start from scratch. Replay reads it where asked, with --state.
struct StateConfig {
  bool enabled = true;
  /// From this file's folder; "" = trust.state in the environment's STATE_DIRECTORY (a service of
  /// systemd with StateDirectory=), else none.
  std::string file;
  double max_age_s = 86400.0;  ///< Older content is not used.
  double period_s = 2.0;       ///< How often it is looked whether something has changed.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("enabled", enabled);
    a.Text("file", file);
    a.Field("max_age_s", max_age_s, {.at_least = 0.0, .at_most = 31536000.0});
    a.Field("period_s", period_s, {.at_least = 0.1, .at_most = 3600.0});
  }
};

/// Everything that a configuration file may hold (daemon/vehicles/advanced.yaml). The defaults are
/// the shipped vehicle.
struct DaemonConfig {
  std::string calibration;  ///< File of calibrated values, from this file's folder; "" = none.
  PerceptionConfig perception;
  GpsBiasConfig gps_bias;
  MountMonitorConfig mount_monitor;
  DetectorConfig detector;  ///< Replay has no use for it: it takes what the network saw.
  LcmConfig lcm;
  StateConfig state;
  /// What `calibration` held; its values are in perception.vehicle already.
  std::optional<CalibrationFile> calibrated;

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("calibration", calibration);
    perception.Visit(a);
    a.Field("gps_bias", gps_bias);
    a.Field("mount_monitor", mount_monitor);
    a.Field("detector", detector);
    a.Field("lcm", lcm);
    a.Field("state", state);
  }
};

/// What one field's bounds cannot say: names that clash or cannot be channel names, ranges the
/// wrong way round.
void CheckConfig(const DaemonConfig& config, const std::string& name,
                 std::vector<std::string>& problems);

/// Defaults where `path` is empty. Files that the configuration names are looked for beside it; the
/// calibration is read and applied. @return false with all problems named. `notes`, where given,
/// takes what is no problem but worth telling, such as a shipped sensor that the file leaves out.
bool LoadDaemonConfig(const std::string& path, DaemonConfig& config,
                      std::vector<std::string>& problems,
                      std::vector<std::string>* notes = nullptr);

/// What `config` of the file at `path` names beside it, by absolute paths: so printed, it means the
/// same from any folder.
void MakeAbsolute(const std::string& path, DaemonConfig& config);

/// The effective configuration as YAML.
std::string PrintDaemonConfig(const DaemonConfig& config);

/// Every key with its range and built-in value, for the reference page.
std::vector<config::Key> DaemonConfigKeys();

}  // namespace v2vouch
