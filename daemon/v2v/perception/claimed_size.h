// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/data/track.h"
#include "daemon/v2v/senders/sender_record.h"
#include "daemon/v2v/trust/trust_config.h"

namespace v2vouch {

/// A LOCAL track as that of a vehicle whose size its sender tells: the near face stays where the
/// sensors have it, and the centre follows from the length. Bayes' rule with the track's own
/// covariance of centre and length:
///
///     k = var(L) / (var(L) + sigma^2),   L' = L + k dL,   p' = p + k dL dp/dL,
///     P' = P - k var(L) dp/dL dp/dL',    dL = claimed length - L
///
/// What the sensors have measured well hardly moves, and a size that cannot be the track's
/// (IsSizePlausible) moves nothing. LOCAL itself never sees this.
/// @param record of the sender; null, or one that tells no size: the track as it is.
LocalTrack GivenClaimedSize(const LocalTrack& track, const SenderRecord* record,
                            const TrustConfig& config);

}  // namespace v2vouch
