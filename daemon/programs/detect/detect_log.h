// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "daemon/common/base/reason.h"
#include "daemon/detector/object_detector.h"
#include "daemon/rim/engine/daemon_config.h"

namespace v2vouch {

struct DetectLogResult {
  std::int64_t events = 0;
  std::int64_t pictures = 0;
  std::int64_t boxes = 0;
  std::int64_t damaged = 0;  ///< Stretches of the log.
  ReasonCounts refused{};
  std::vector<std::string> unknown_pictures;  ///< Channels of pictures that no camera has.
};

/// Copies a log and puts behind every picture of a camera with `source: image` what the detector
/// saw in it, on CAMERA_<NAME>_DETECTED and as the daemon would have published it; older ones of
/// the same channel are left out. Such a log is replayed without any network.
/// @param progress called with the share done; false stops.
/// @return false with `error` set when a file cannot be read or written, or when stopped.
bool DetectLog(const std::string& in, const std::string& out, const DaemonConfig& config,
               ObjectDetector& detector, const std::function<bool(double)>& progress,
               DetectLogResult& result, std::string& error);

}  // namespace v2vouch
