// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/outputs.h"

namespace v2vouch {

/// What outlives a restart of the trust in one sender. Ages instead of times: the clock of messages
/// may be another one afterwards.
struct TrustMemory {
  SenderId sender = 0;
  CertificateDigest certificate{};  ///< All zero: none.
  /// SUSPECT, REVOKED: the penalty goes on. CANDIDATE: validated until `since_s` ago, no blame;
  /// it is validated again by the sensors, sooner than a stranger. Never VALIDATED itself.
  TrustState state = TrustState::kNone;
  int suspicions = 0;
  int accusations = 0;
  double since_s = 0.0;    ///< In this state for so long.
  double finding_s = 0.0;  ///< Last finding against it so long ago.
};

/// More are not kept: penalties go first, then the newest.
inline constexpr std::size_t kMostTrustMemories = 512;

/// The kept ones of `all`, ordered by sender; of a sender that comes twice the graver.
std::vector<TrustMemory> BoundedTrust(std::vector<TrustMemory> all);

/// What the trust file held at start, until each sender is heard again. Copyable; a function of the
/// events in order of time.
class RestoredTrust {
 public:
  RestoredTrust() = default;
  /// Ages are counted from the first event on.
  explicit RestoredTrust(std::vector<TrustMemory> memories)
      : memories_(BoundedTrust(std::move(memories))) {}

  /// The first event's time sets where the ages count from.
  void OnEvent(Timestamp stamp) {
    if (!memories_.empty() && !began_) began_ = stamp;
  }
  /// Hands out what is known of a newcomer, by its id or its certificate, once. Ages are as of
  /// `now`.
  std::optional<TrustMemory> TakeFor(SenderId sender, const CertificateDigest& certificate,
                                     Timestamp now);
  [[nodiscard]] TrustState StateOf(SenderId sender) const;  ///< kNone: nothing is known.
  /// What has not been asked for yet. Ages are as of `now`.
  [[nodiscard]] std::vector<TrustMemory> Left(Timestamp now) const;

 private:
  [[nodiscard]] TrustMemory Aged(TrustMemory memory, Timestamp now) const;

  std::vector<TrustMemory> memories_;  // By sender.
  std::optional<Timestamp> began_;
};

}  // namespace v2vouch
