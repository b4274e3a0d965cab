// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "daemon/common/assignment/assignment.h"
#include "daemon/common/data/input.h"
#include "daemon/v2v/association/association_config.h"
#include "daemon/v2v/association/pair_evidence.h"

namespace v2vouch {

/// Candidate pairs of senders and LOCAL tracks, and the global one-to-one choice among them
///. Bounded; copyable (a copy leaves work space behind); ordered by sender,
/// then track.
class PairTable {
 public:
  struct Pair {
    SenderId sender = 0;
    std::uint64_t track_id = 0;
    bool is_incumbent = false;  ///< Validated: gets the bonus and blocks the track for others.
    bool is_assigned = false;   ///< Chosen by the last Assign().
    PairEvidence evidence;
  };

  /// Adds one observation; starts the pair where it lies within the gate and there is room.
  /// @return the pair, or null where none was started. Valid until the table changes.
  Pair* Observe(SenderId sender, std::uint64_t track_id, const PairObservation& observation,
                const std::optional<BiasPrior>& prior, const AssociationConfig& config);

  /// Chooses pairs: maximum total score, one track per sender and one sender per track; a pair
  /// must score above 0; an incumbent has its bonus.
  void Assign(const AssociationConfig& config);

  /// By how much a pair beats every other pair that shares its sender or its track. Tracks held by
  /// another sender's validated pair are out of the question and do not count as rivals.
  /// @return infinity where it has no rival.
  [[nodiscard]] double Margin(const Pair& pair) const;

  [[nodiscard]] const Pair* AssignedTo(SenderId sender) const;
  [[nodiscard]] Pair* Find(SenderId sender, std::uint64_t track_id);
  [[nodiscard]] std::span<const Pair> pairs() const { return pairs_; }

  /// Marks (or with nullopt unmarks) the validated pair of a sender.
  void SetIncumbent(SenderId sender, std::optional<std::uint64_t> track_id);
  void DropSender(SenderId sender);
  /// Takes over what another table holds of a sender, as far as there is room.
  void TakeFrom(PairTable& other, SenderId sender, const AssociationConfig& config);
  /// Drops pairs not observed for the timeout.
  void Expire(Timestamp now, const AssociationConfig& config);

 private:
  // Work space of Assign(): not part of the state, so a checkpoint does not carry it.
  struct Scratch {
    Scratch() = default;
    Scratch(const Scratch&) noexcept {}
    Scratch& operator=(const Scratch&) noexcept { return *this; }
    ClusteredAssignmentSolver solver;
    std::vector<SparsePair> sparse;
    std::vector<std::uint64_t> tracks;
    std::vector<double> lone;
    std::vector<int> row, column;
  };

  std::vector<Pair> pairs_;
  Scratch scratch_;
};

}  // namespace v2vouch
