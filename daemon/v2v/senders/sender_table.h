// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "daemon/v2v/senders/sender_record.h"
#include "daemon/v2v/trust/tombstones.h"
#include "daemon/v2v/trust/trust_memory.h"

namespace v2vouch {

/// How many senders have a record.
struct SenderLimits {
  std::size_t most = 128;     ///< At a time.
  double turnover_hz = 40.0;  ///< Newcomers that may take another's record, once all are taken.
};

/// What would be lost with a sender's record.
enum class SenderHolds : std::uint8_t {
  kNothing,
  kTrack,    ///< A LOCAL track is assigned to it.
  kVehicle,  ///< A PRIORITY vehicle rests on it: never evicted.
};

/// The senders near the car, one record each; bounded. Beside them what outlives a record: the
/// tombstones of penalised senders, and what an earlier run of the program knew.
///
/// Where more senders speak than have room, admission is a token bucket: if every newcomer were
/// admitted at once, no sender's second message would find the record of its first, and none could
/// be judged. Evicted are first the penalised (tombstones keep their state), then senders without a
/// LOCAL track, then others; among equals the one silent for longest. A sender with a vehicle is
/// never evicted, so no flood of identities can drive it out.
///
/// Copyable: part of every checkpoint. A function of the events in order of time.
class SenderTable {
 public:
  [[nodiscard]] SenderRecord* Find(SenderId sender);
  [[nodiscard]] const SenderRecord* Find(SenderId sender) const;
  [[nodiscard]] std::span<SenderRecord> records() { return records_; }
  [[nodiscard]] std::span<const SenderRecord> records() const { return records_; }

  struct Admission {
    SenderRecord* record = nullptr;   ///< Null: no room. Valid until the table changes.
    std::optional<SenderId> evicted;  ///< Whose record was given up for it.
  };
  /// A record for a sender that has none. Penalties are inherited from the tombstone of the
  /// sender, of its certificate or of its likely predecessor; else from the earlier run.
  /// @param here its claim.  @param holds what would be lost with another sender's record.
  Admission Admit(const Claim& claim, const ClaimInOdometry& here, const SenderLimits& limits,
                  const TombstoneConfig& tombstones,
                  const std::function<SenderHolds(SenderId)>& holds);

  void Remove(SenderId sender);
  /// Drops records of senders silent for more than `contact_s` that hold no vehicle.
  void DropSilent(Timestamp now, double contact_s,
                  const std::function<SenderHolds(SenderId)>& holds);

  /// Sets the tombstone of a sender with a penalty or a doubt, removes that of any other.
  void UpdateTombstone(const SenderRecord& record);

  /// Of its record, else of its tombstone, else of the earlier run; kUnknown: never heard of.
  [[nodiscard]] TrustState TrustOf(SenderId sender) const;

  /// What of the trust in senders outlives a restart; ages as of `now`.
  /// @param again_s so long after its release a sender is validated again sooner.
  [[nodiscard]] std::vector<TrustMemory> TrustToKeep(Timestamp now, double again_s) const;
  /// Before the first event: what an earlier run kept.
  void RestoreTrust(std::vector<TrustMemory> memories) {
    restored_ = RestoredTrust(std::move(memories));
  }
  /// The first event's time sets where restored ages count from.
  void OnEvent(Timestamp stamp) { restored_.OnEvent(stamp); }

 private:
  bool TakeToken(Timestamp now, double rate_hz);
  std::vector<SenderRecord>::iterator LeastLost(bool for_penalised,
                                                const std::function<SenderHolds(SenderId)>& holds);

  std::vector<SenderRecord> records_;  // By sender.
  double tokens_ = 0.0;                // Newcomers that may take another's record now.
  std::optional<Timestamp> refilled_;
  Tombstones tombstones_;
  RestoredTrust restored_;  // Of senders not heard since the start.
};

}  // namespace v2vouch
