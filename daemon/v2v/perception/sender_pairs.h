// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "daemon/common/data/bias.h"
#include "daemon/common/data/claim.h"
#include "daemon/v2v/association/pair_table.h"
#include "daemon/v2v/perception/priority_config.h"
#include "daemon/v2v/perception/track_snapshots.h"
#include "daemon/v2v/senders/sender_record.h"

namespace v2vouch {

/// Which sender may be which LOCAL track: the pairs of senders on the ego's level, which are
/// matched one to one, and apart from them the pairs of senders on another level. Those take no
/// track and compete with no pair, but should the difference in height turn out to be common to
/// all, their observations count. Copyable: part of every checkpoint.
class SenderPairs {
 public:
  /// Adds a claim to the evidence of each LOCAL track near by (20 m), and matches anew.
  /// @param prior GPS bias of the sender, for pairs that start now.
  void Observe(const SenderRecord& record, const ClaimInOdometry& claim, bool is_on_another_level,
               const TrackSnapshots& tracks, const std::optional<BiasPrior>& prior,
               const PriorityConfig& config);

  [[nodiscard]] const PairTable& on_level() const { return on_level_; }
  [[nodiscard]] bool HasTrack(std::uint64_t local_id) const;
  /// On the ego's level, else apart; null: none.
  [[nodiscard]] const PairTable::Pair* AssignedTo(SenderId sender) const;

  void SetIncumbent(SenderId sender, std::optional<std::uint64_t> local_id) {
    on_level_.SetIncumbent(sender, local_id);
  }
  /// Takes over what was observed of a sender while it seemed to be on another level.
  void BringToLevel(SenderId sender, const AssociationConfig& config) {
    on_level_.TakeFrom(apart_, sender, config);
  }
  void Assign(const AssociationConfig& config) { on_level_.Assign(config); }
  void DropFromLevel(SenderId sender) { on_level_.DropSender(sender); }
  void Drop(SenderId sender);
  void Expire(Timestamp now, const AssociationConfig& config);
  [[nodiscard]] std::size_t size_bytes() const {
    return on_level_.pairs().size_bytes() + apart_.pairs().size_bytes();
  }

 private:
  PairTable on_level_;
  PairTable apart_;
};

}  // namespace v2vouch
