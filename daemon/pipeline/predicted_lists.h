// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "daemon/common/data/outputs.h"
#include "daemon/pipeline/perception_config.h"
#include "daemon/pipeline/timeline.h"

namespace v2vouch {

/// LOCAL as a list: the confirmed tracks of a frame.
void ListLocal(const LocalFrame& frame, std::int64_t seq, int revision, TrackList& list);

/// Carries `outputs.local`, the newest frame's list, to `at` (not before it) and makes the PRIORITY
/// list beside it: marked stale, all sectors blind, empty once a hidden vehicle would be given up.
void PredictLists(const Timeline& timeline, const PerceptionConfig& config, Timestamp at,
                  Outputs& outputs);

}  // namespace v2vouch
