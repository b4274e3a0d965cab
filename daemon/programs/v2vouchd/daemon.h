// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "daemon/programs/v2vouchd/detect_thread.h"
#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/wire/status.h"

namespace v2vouch {

/// What a run of the daemon came to, for its last words.
struct DaemonSummary {
  std::int64_t accepted = 0;
  std::int64_t lists = 0;
  std::int64_t stale_lists = 0;
  std::int64_t withheld_lists = 0;  ///< Older than a predicted copy that had gone out.
  std::int64_t queue_drops_own = 0;
  std::int64_t queue_drops_bsm = 0;
  ReasonCounts refused{};
  std::vector<wire::DroppedDatagrams> dropped;
  std::string digest_local;
  std::string digest_priority;
};

/// Runs until `must_stop`, checked every 20 ms at least. The calling thread becomes the fusion
/// thread and the only publisher; a receive thread per LCM URL only drains, the detect thread looks
/// at pictures.
/// @param detector nullptr where no network is configured.
DaemonSummary RunDaemon(const DaemonConfig& config, ObjectDetector* detector,
                        const std::function<bool()>& must_stop);

}  // namespace v2vouch
