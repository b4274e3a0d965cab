// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "daemon/common/data/vehicle.h"
#include "daemon/v2v/association/pair_table.h"
#include "daemon/v2v/perception/priority_config.h"
#include "daemon/v2v/perception/track_snapshots.h"
#include "daemon/v2v/priority/priority_list.h"
#include "daemon/v2v/senders/sender_table.h"

namespace v2vouch {

/// What the judgements of the V2V side may look at, and nothing that they may change: tracks,
/// senders, pairs of both, and the PRIORITY vehicles. References; made for one call.
struct V2vView {
  const PriorityConfig& config;
  const VehicleConfig& vehicle;
  const TrackSnapshots& tracks;
  const SenderTable& senders;
  const PairTable& pairs;  ///< Of senders on the ego's level.
  const PriorityList& list;
};

/// Not validated, perhaps never: but a LOCAL track is assigned to another sender than this one,
/// after enough co-observations, and that sender has no penalty.
bool IsAssignedToAnother(const V2vView& view, std::uint64_t local_id, SenderId sender);

/// Another sender's vehicle is seen as this LOCAL track, or the track is assigned to another.
bool IsAnothers(const V2vView& view, std::uint64_t local_id, SenderId sender);

/// Whether the sensors see the sender: a LOCAL track that is no other sender's vehicle, was hit
/// lately, and agrees with it but for an offset that may be its GNSS bias.
bool IsSeenBySensors(const V2vView& view, const SenderRecord& record);

}  // namespace v2vouch
