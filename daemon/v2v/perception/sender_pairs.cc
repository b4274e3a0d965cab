// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/sender_pairs.h"

#include <algorithm>

#include "daemon/v2v/perception/claimed_size.h"
#include "daemon/v2v/perception/evidence.h"

namespace v2vouch {
namespace {

constexpr double kPairReach_m = 20.0;  // No claim, however poor, starts a pair from farther away.

}  // namespace

void SenderPairs::Observe(const SenderRecord& record, const ClaimInOdometry& claim,
                          bool is_on_another_level, const TrackSnapshots& tracks,
                          const std::optional<BiasPrior>& prior, const PriorityConfig& settings) {
  const AssociationConfig& config = settings.safe;
  const double dt_s = ToSeconds(claim.stamp - tracks.stamp());
  if (tracks.tracks().empty() || dt_s > TrackSnapshots::kMaxAge_s) return;
  PairTable& pairs = is_on_another_level ? apart_ : on_level_;
  if (!is_on_another_level) BringToLevel(claim.sender, config);
  bool has_changed = false;
  for (const TrackSnapshot& snapshot : tracks.tracks()) {
    const double distance_m = (snapshot.track.state_O.mean.head<2>() - claim.p_O).norm();
    const bool is_known = pairs.Find(claim.sender, snapshot.track.id) != nullptr;
    if (distance_m > kPairReach_m && !is_known) continue;
    KinematicState state = GivenClaimedSize(snapshot.track, &record, settings.trust).state_O;
    if (dt_s > 0.0) PredictCtra(state, dt_s, settings.filter.motion);
    has_changed |= pairs.Observe(claim.sender, snapshot.track.id, Compare(claim, state), prior,
                                 config) != nullptr;
  }
  if (has_changed) pairs.Assign(config);
}

bool SenderPairs::HasTrack(std::uint64_t local_id) const {
  const auto is_of_track = [&](const PairTable::Pair& pair) { return pair.track_id == local_id; };
  return std::ranges::any_of(on_level_.pairs(), is_of_track) ||
         std::ranges::any_of(apart_.pairs(), is_of_track);
}

const PairTable::Pair* SenderPairs::AssignedTo(SenderId sender) const {
  const PairTable::Pair* pair = on_level_.AssignedTo(sender);
  return pair != nullptr ? pair : apart_.AssignedTo(sender);
}

void SenderPairs::Drop(SenderId sender) {
  on_level_.DropSender(sender);
  apart_.DropSender(sender);
}

void SenderPairs::Expire(Timestamp now, const AssociationConfig& config) {
  on_level_.Expire(now, config);
  apart_.Expire(now, config);
}

}  // namespace v2vouch
