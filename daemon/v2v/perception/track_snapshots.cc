// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/track_snapshots.h"

#include <algorithm>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

// So long after a partial observation the state may be off, and so long must a vehicle be observed
// whole before it is trusted again.
constexpr double kPartial_s = 0.5;
// What passes covers a vehicle within so long. Beyond that a liar could walk off unseen.
constexpr double kBriefly_s = 3.5;
// By how much the measurements of a part may mislead: one sigma.
constexpr double kPartialPosition_m = 0.5;
constexpr double kPartialYaw_rad = FromDegrees(8.0);
constexpr double kPartialSpeed_mps = 0.7;

void Widen(StateMatrix& P) {
  P(kX, kX) += kPartialPosition_m * kPartialPosition_m;
  P(kY, kY) += kPartialPosition_m * kPartialPosition_m;
  P(kYaw, kYaw) += kPartialYaw_rad * kPartialYaw_rad;
  P(kSpeed, kSpeed) += kPartialSpeed_mps * kPartialSpeed_mps;
}

}  // namespace

void TrackSnapshots::Begin(Timestamp stamp) {
  stamp_ = stamp;
  carried_.clear();
  for (const TrackSnapshot& snapshot : tracks_) {
    if (snapshot.partial) carried_.push_back(*snapshot.partial);
  }
  tracks_.clear();
}

void TrackSnapshots::Add(const LocalTrack& track, const Observed& observed) {
  TrackSnapshot& snapshot = tracks_.emplace_back(
      TrackSnapshot{.track = track, .is_sure = observed.is_sure, .is_hit = observed.is_hit});
  const auto before = std::ranges::find(carried_, track.id, &PartialObservation::track_id);
  if (before != carried_.end()) snapshot.partial = *before;
  if (observed.is_partial) {
    const auto& so_far = snapshot.partial;
    const bool goes_on =
        so_far && (!so_far->whole || ToSeconds(stamp_ - *so_far->whole) < kPartial_s);
    snapshot.partial =
        PartialObservation{track.id, stamp_, std::nullopt, goes_on ? so_far->first : stamp_};
  } else if (observed.is_hit && snapshot.partial && !snapshot.partial->whole) {
    snapshot.partial->whole = stamp_;
  }
  if (!snapshot.partial) return;
  const auto& [id, last, whole, first] = *snapshot.partial;
  snapshot.is_partial = ToSeconds(stamp_ - last) <= kPartial_s;
  snapshot.is_briefly_partial = snapshot.is_partial && ToSeconds(stamp_ - first) <= kBriefly_s;
  // A track that coasts goes on as the part had it, however long.
  snapshot.is_doubtful = !whole || ToSeconds(track.support.last() - *whole) < kPartial_s;
  if (snapshot.is_partial) Widen(snapshot.track.state_O.covariance);
}

const TrackSnapshot* TrackSnapshots::Find(std::uint64_t local_id) const {
  if (local_id == 0) return nullptr;
  const auto at = std::ranges::find_if(
      tracks_, [&](const TrackSnapshot& snapshot) { return snapshot.track.id == local_id; });
  return at == tracks_.end() ? nullptr : &*at;
}

}  // namespace v2vouch
