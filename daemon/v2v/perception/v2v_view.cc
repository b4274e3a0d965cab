// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/v2v_view.h"

#include <algorithm>

#include "daemon/v2v/perception/evidence.h"

namespace v2vouch {

bool IsAssignedToAnother(const V2vView& view, std::uint64_t local_id, SenderId sender) {
  return std::ranges::any_of(view.pairs.pairs(), [&](const PairTable::Pair& pair) {
    if (pair.track_id != local_id || pair.sender == sender || !pair.is_assigned) return false;
    if (pair.evidence.observations() < view.config.trust.co_observations) return false;
    const TrustState state = view.senders.TrustOf(pair.sender);
    return state != TrustState::kSuspect && state != TrustState::kRevoked;
  });
}

bool IsAnothers(const V2vView& view, std::uint64_t local_id, SenderId sender) {
  return view.list.HoldsForAnother(local_id, sender) || IsAssignedToAnother(view, local_id, sender);
}

bool IsSeenBySensors(const V2vView& view, const SenderRecord& record) {
  const PairTable::Pair* pair = view.pairs.AssignedTo(record.sender);
  if (pair == nullptr || view.list.HoldsForAnother(pair->track_id, record.sender)) return false;
  if (pair->evidence.level() > view.config.safe.max_level) return false;
  const TrackSnapshot* seen = view.tracks.Find(pair->track_id);
  return seen != nullptr && WasHitLately(seen->track, view.tracks.stamp());
}

}  // namespace v2vouch
