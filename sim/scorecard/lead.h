// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/scorecard/scene.h"
#include "sim/scorecard/summary.h"

namespace v2vouch::evaluation {

/// How a list treats the vehicle that the ego follows.
struct LeadFigures {
  std::int64_t lists = 0;   ///< Scored lists with a lead vehicle.
  std::int64_t absent = 0;  ///< ... and no track within 5 m along and 2 m across of it.
  double longest_absence_s = 0.0;
  Sample along_m;  ///< Track minus truth along the ego's axis, the nearest such track.

  [[nodiscard]] double absent_share() const;
};

/// The lead vehicle is the nearest vehicle with its centre 4 to 50 m ahead of the ego's rear axle
/// and within 1.6 m of the ego's path (an arc of its present yaw rate over speed, straight below 2
/// m/s), while 80 % of it has been in sight of an own sensor for 2 s. A vehicle out of the list's
/// scope gives no lead.
LeadFigures JudgeLead(const std::vector<Scene>& scenes, const ScorecardSettings& settings);

}  // namespace v2vouch::evaluation
