// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/scorecard/scene.h"
#include "sim/scorecard/summary.h"

namespace v2vouch::evaluation {

/// How long vehicles that could be listed take to come into a list.
struct FirstListingFigures {
  Sample delay_s;  ///< Time in sight before the first listing, per listed vehicle.
  int never = 0;   ///< Vehicles that were so for a second in all and were not listed.
};
struct FirstListings {
  FirstListingFigures moving;  ///< Moving and in clear sight of any own sensor.
  FirstListingFigures plain;   ///< Moving or standing, in plain sight of a radar and a camera.
};

/// Within `near_m`; the first `skip_s` of the run counts too. Listed: matched to a track whose
/// centre is within half the vehicle's length and 2 m. A vehicle that was listed before it came
/// into sight has a delay of 0.
FirstListings JudgeFirstListing(const RunLog& log, const std::vector<Scene>& scenes,
                                const ScorecardSettings& settings);

}  // namespace v2vouch::evaluation
