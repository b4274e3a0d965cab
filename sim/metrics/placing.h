// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {

/// A listed track put into the world at some instant.
struct PlacedTrack {
  const ListedTrack* track = nullptr;
  PlanarMotion motion_W;
  Eigen::Matrix2d covariance_W = Eigen::Matrix2d::Zero();  ///< As listed, turned into W.
};

/// The list's tracks at `t`: body-frame states through the true ego pose at the list's own time,
/// then carried on with Predict(). LOCAL's pedestrians and cyclists are left out. Empty where the
/// list is null or outside the truth's time.
std::vector<PlacedTrack> PlaceTracks(const RunLog& log, const ReceivedList* list, ListKind kind,
                                     Timestamp t);

}  // namespace v2vouch::evaluation
