// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calibration/extrinsics/drive_log.h"
#include "daemon/rim/engine/daemon_config.h"

namespace v2vouch {

/// Recorded drives, one after the other, as the car's own sensors saw them.
struct Drive {
  DriveLog own;
  std::vector<std::string> log_sha256;  ///< Of each file's bytes, in the order given.
  Timestamp newest{};                   ///< Stamp of the newest event in any of them.
  std::int64_t events = 0;
  std::int64_t damaged = 0;  ///< Stretches of a log that could not be read.
  std::int64_t refused = 0;  ///< Messages that were not taken.
};

/// Reads logs through the daemon's own decoder. BSMs and lists are passed over.
/// @param progress share of all bytes read.
/// @return false with `error` where a file cannot be read or has nothing of this vehicle.
bool ReadDrive(const std::vector<std::string>& logs, const DaemonConfig& config, Drive& drive,
               std::string& error, const std::function<void(double)>& progress);

}  // namespace v2vouch
