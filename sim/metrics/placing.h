// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "sim/metrics/sight.h"
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

/// Which true vehicles a list is held against.
enum class Against {
  kOwnScope,     ///< LOCAL: every vehicle, parked ones too. PRIORITY and V2V: those that send BSMs.
  kAllVehicles,  ///< Every vehicle for every list, as the paper does.
};

/// A true vehicle at some instant.
struct PlacedTruth {
  std::size_t object = 0;
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
  Sighting sighting = Sighting::kVisible;

  [[nodiscard]] bool is_seen() const { return sighting == Sighting::kVisible; }
};

/// The true vehicles that the list is held against at `t`.
std::vector<PlacedTruth> PlaceTruths(const RunLog& log, ListKind kind, Against against, Timestamp t,
                                     const Pose<World, Body>& X_WB);

/// Whether a pedestrian or cyclist is within `reach_m`.
bool IsBesideRoadUser(const Truth& truth, const Eigen::Vector2d& p_W, Timestamp t, double reach_m);

/// Squared normalised position error of a track at its list's time; NaN = unusable.
double NeesAt(const RunLog& log, const TruthObject& object, const ReceivedList& list,
              const ListedTrack& track);

}  // namespace v2vouch::evaluation
