// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "daemon/common/base/notice.h"
#include "daemon/common/base/scratch.h"
#include "daemon/common/data/ego.h"
#include "daemon/common/data/input.h"
#include "daemon/v2v/association/height_offset.h"
#include "daemon/v2v/association/height_track.h"
#include "daemon/v2v/senders/sender_record.h"

namespace v2vouch {

/// Whose height puts it on a bridge over the ego or on a road below it, and what is only another
/// zero of heights (HeightOffset). Vehicles on one road differ by what the road climbs between
/// them: nothing, as much as it climbs under the ego, as much as it climbs under the sender, or
/// something between these. Copyable: part of every checkpoint.
class HeightJudge {
 public:
  /// The ego's own height. @param ego at the time of the fix.
  void OnFix(const GnssFix& fix, const EgoState& ego);
  /// A sender's height from its message; updates the record's `height`.
  /// @return the way that it has driven since its last message [m].
  double OnClaim(SenderRecord& record, const Claim& claim, const ClaimInOdometry& here,
                 const EgoState& ego) const;

  /// @param allowed_m difference on one level that grade and offset do not explain.
  [[nodiscard]] bool IsOnAnotherLevel(const SenderRecord& record, double allowed_m) const;

  /// Whether all heights differ from the ego's alike, by all senders heard lately.
  /// @return whether the offset changed: then other senders are on the ego's level than before.
  bool Judge(std::span<const SenderRecord> records, Timestamp now, double allowed_m);

  /// Appends what the heights say of the ego's receiver.
  void CollectNotices(std::vector<Notice>& notices) const;

 private:
  HeightTrack ego_;
  std::optional<Eigen::Vector2d> ego_at_;  // Place of the last fix.
  HeightOffset offset_;
  Scratch<std::vector<HeightWitness>> witnesses_;
};

}  // namespace v2vouch
