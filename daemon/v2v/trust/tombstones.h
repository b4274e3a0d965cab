// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "daemon/common/base/time.h"
#include "daemon/common/data/input.h"
#include "daemon/v2v/trust/claimed_place.h"
#include "daemon/v2v/trust/sender_trust.h"
#include "daemon/v2v/trust/tombstone_config.h"

namespace v2vouch {

/// Where penalised and doubted senders were last heard, so that no new identity clears a penalty.
/// Keyed by certificate where there is one, and by position and motion: a sender that was never
/// heard before the old one fell silent, and continues where its claims would be now, is its
/// successor. A car that was heard beside the liar is not.
///
/// Fixed size: the oldest tombstone is replaced. Copyable.
class Tombstones {
 public:
  struct Stone {
    SenderId sender = 0;
    CertificateDigest certificate{};
    Timestamp last{};  ///< The old sender's last claim.
    Eigen::Vector2d p_O = Eigen::Vector2d::Zero();
    Eigen::Vector2d v_O = Eigen::Vector2d::Zero();
    Penalty penalty;
    ClaimedPlace place;  ///< Doubt that has not led to a penalty yet.
  };

  /// A penalised sender has spoken (or was just penalised): sets or moves its tombstone.
  void Set(const Stone& stone);
  /// No longer penalised or doubted.
  void Remove(SenderId sender);
  [[nodiscard]] const Stone* Find(SenderId sender) const;

  [[nodiscard]] std::span<const Stone> stones() const { return {stones_.data(), count_}; }

  /// The tombstone a successor inherits, which is then removed; nullopt: none.
  /// @param first_heard when the newcomer was heard for the first time ever.
  std::optional<Stone> TakeFor(SenderId sender, const CertificateDigest& certificate,
                               Timestamp first_heard, Timestamp now, const Eigen::Vector2d& p_O,
                               const Eigen::Vector2d& v_O, const TombstoneConfig& config);

 private:
  static constexpr std::size_t kStones = 32;
  std::array<Stone, kStones> stones_{};
  std::size_t count_ = 0;
};

}  // namespace v2vouch
