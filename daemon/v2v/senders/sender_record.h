// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "daemon/common/data/bias.h"
#include "daemon/common/data/claim.h"
#include "daemon/v2v/association/height_track.h"
#include "daemon/v2v/trust/claimed_place.h"
#include "daemon/v2v/trust/sender_trust.h"
#include "daemon/v2v/trust/shared_place.h"

namespace v2vouch {

/// Where a vehicle may stand or drive that no sensor sees, just before or behind a LOCAL track.
struct UnseenNeighbours {
  std::uint64_t track_id = 0;                               ///< 0: not searched yet.
  std::array<std::optional<Eigen::Vector2d>, 2> offsets_O;  ///< From the track's centre [m].
};

/// A sender's height beside the ego's.
struct SenderHeight {
  HeightTrack track;
  std::optional<Timestamp> last;       ///< Of the last message.
  std::optional<double> difference_m;  ///< Above the ego when last heard; nullopt: unknown.
  double least_m = 0.0;                ///< Smallest difference that the road explains ...
  double most_m = 0.0;                 ///< ... and largest, less what is common to all.
  double agreed_m = 0.0;  ///< Way for which a LOCAL track agreed with the sender, height left out.
};

/// All that is known of one sender near the car: what it said last, the trust in it, and what the
/// sensors have seen where it says it is. Copyable, fixed size.
struct SenderRecord {
  static constexpr double kRecent_s = 0.4;  ///< An older claim is no use for a visibility query.

  SenderId sender = 0;
  CertificateDigest certificate{};
  SenderTrust trust;

  // --- What it said.
  Timestamp first_heard{};           ///< Its first message, whether or not it was followed then.
  ClaimInOdometry last;              ///< Newest claim with a position of use.
  bool has_last = false;             ///< False: none yet, or none in the present alignment.
  std::optional<double> length_m{};  ///< As claimed.
  std::optional<double> width_m{};   ///< As claimed.
  SenderHeight height{};
  /// Above 0: one of its latest messages did not continue the one before. Counts messages down.
  int breaks = 0;
  int odd_claims = 0;  ///< Claims in a row that are not where the sensors see the sender.

  // --- What the sensors say of it.
  ClaimedPlace place{};            ///< Evidence that its claimed position is empty.
  SharedPlace shared{};            ///< Evidence that others claim the same position.
  UnseenNeighbours unseen{};       ///< Beside the LOCAL track that it may be.
  std::uint64_t compared_id = 0;   ///< LOCAL track of the last residual; 0 = none.
  std::uint64_t withdrawn_id = 0;  ///< LOCAL track it was validated on when withdrawn; 0 = none.
  std::optional<BiasEstimate> prior_en{};  ///< Settled GPS bias, prior of new pairs.

  // --- Whether it is the new pseudonym of another sender.
  std::uint64_t continues_id = 0;  ///< PRIORITY vehicle that it may continue; 0 = none.
  int continues_claims = 0;        ///< Claims in a row that fit that vehicle.

  /// Whether its last claim is fresh enough to query visibility at its position at `now`.
  [[nodiscard]] bool IsRecent(Timestamp now) const {
    return has_last && std::abs(ToSeconds(now - last.stamp)) <= kRecent_s;
  }
};

}  // namespace v2vouch
