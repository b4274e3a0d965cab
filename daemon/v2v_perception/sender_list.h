// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "daemon/data/outputs.h"
#include "daemon/v2v/intake.h"
#include "daemon/v2v_perception/v2v_perception.h"

namespace v2vouch {

/// Where the ego's footprint is on the globe. Requires alignment.is_ready().
EgoPlace PlaceOf(const Alignment& alignment, const EgoState& ego, const VehicleConfig& vehicle);

/// TRACKS_V2V: every sender as heard, its own filtered claim carried forward to `at` and brought
/// into O, with its trust and bias (of its vehicle's filter where it has one, else as last
/// settled). Nobody drives by it. Empty before the alignment is ready.
void ListSenders(std::span<const SenderTrack> senders, const V2vPerception& priority,
                 const BiasReport& settled, Timestamp at, std::vector<PublishedTrack>& lines);

}  // namespace v2vouch
