// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/data/track.h"
#include "daemon/local/visibility/visibility.h"
#include "daemon/v2v/perception/v2v_view.h"

namespace v2vouch {

/// Where the sender of a vehicle that the sensors see as `track` has it: by its claim, less the
/// residual that its claims had ten seconds ago, of the size that the sensors give it. A LOCAL
/// track that a partial observation drags along lies in clear view all the time, since its own
/// footprint moves with the observed part; this footprint shows that the rest is hidden.
/// @return nullopt where the track is no PRIORITY vehicle, or its residual has not settled.
std::optional<Occluder> ExpectedFootprint(const V2vView& view, const LocalTrack& track,
                                          Timestamp stamp);

/// Whether a measurement of this frame is a partial observation of the track's vehicle: the rest is
/// occluded or out of view, by the track's own footprint or by the expected one.
bool IsPartiallyObserved(const V2vView& view, const LocalTrack& track,
                         const std::optional<Occluder>& expected, const LocalFrame& frame,
                         const VisibilityMap& map);

}  // namespace v2vouch
