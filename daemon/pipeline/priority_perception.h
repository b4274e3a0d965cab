// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/data/bias.h"
#include "daemon/data/claim.h"
#include "daemon/data/outputs.h"
#include "daemon/data/track.h"
#include "daemon/visibility/visibility.h"

namespace v2vouch {

// Interface that the timeline relies on; the rolled-back V2V part.
//
//   class PriorityPerception {            // copyable: a copy is a checkpoint
//    public:
//     PriorityPerception(const PriorityConfig& config, const VehicleConfig& vehicle);
//     void OnFix(const GnssFix& fix, const EgoState& ego, Outputs& outputs);
//     void OnFrame(const LocalFrame& frame, const VisibilityMap& map, Outputs& outputs);
//     void OnClaim(const Claim& claim, const EgoState& ego, Outputs& outputs);
//     void Publish(Timestamp at, TrackList& priority) const;   // tracks predicted to `at`
//     const Alignment& alignment() const;
//     TrustState TrustOf(SenderId sender) const;
//   };

}  // namespace v2vouch
