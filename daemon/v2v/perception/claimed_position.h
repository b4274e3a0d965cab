// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "daemon/common/data/track.h"
#include "daemon/local/visibility/visibility.h"
#include "daemon/v2v/perception/v2v_view.h"

namespace v2vouch {

/// Size of a sender that claims none: a car's (ClassExtent).
inline constexpr double kUsualLength_m = 4.5;
inline constexpr double kUsualWidth_m = 1.8;

/// The vehicle that the sender says it is, at a position: of the claimed size, else a car's.
Occluder ClaimedFootprint(const SenderRecord& record, const Eigen::Vector2d& centre_O,
                          double yaw_rad);

/// Check empty_place: what the sensors see where the sender says it is, and round there as far as
/// its GNSS bias may reach (ClaimedPlace::Places).
std::array<ClaimedPlace::Look, ClaimedPlace::kPlaces> ObserveClaimedPosition(
    const V2vView& view, const SenderRecord& record, const LocalFrame& frame,
    const VisibilityMap& map);

/// Check shared_place: whether another sender claims the same position and motion, and the sensors
/// see one vehicle there.
bool IsPositionShared(const V2vView& view, const SenderRecord& record, Timestamp now);

/// Whether a vehicle may be unseen just before or behind the LOCAL track that the sender is
/// assigned to: in a queue both are stationary, and a GNSS bias of half the headway fits either.
UnseenNeighbours FindUnseenNeighbours(const V2vView& view, const SenderRecord& record,
                                      const LocalFrame& frame, const VisibilityMap& map);

/// By how much (log-likelihood) the pair's track fits better than its unseen neighbours; 0 where
/// they have not been searched yet, infinity where there are none.
double MarginOverUnseen(const SenderRecord& record, const PairTable::Pair& pair);

}  // namespace v2vouch
