// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/warnings/conflict.h"
#include "daemon/warnings/warning.h"
#include "daemon/warnings/warnings_config.h"

namespace v2vouch::warnings {

/// A vehicle slower than this stands: no direction of motion is taken from it.
inline constexpr double kTargetStands_mps = 1.0;

/// A listed vehicle in the body frame of an ego at `ego_p_O`, `ego_yaw_O`.
BodyTarget InBody(const Target& target, const Eigen::Vector2d& ego_p_O, double ego_yaw_O);

/// A box well inside the ego's own: contact already, or a track of nothing; no warning helps.
bool IsInEgo(const BodyTarget& target, const EgoBody& body);

/// Where a vehicle is as the ego drives: by the predicted path, not by bearing.
enum class Zone {
  kAhead,       ///< In the ego's path, same direction or standing.
  kAheadAside,  ///< Same direction, beside the path.
  kBehind,      ///< Same direction, behind the driver's eye.
  kOncoming,
  kFromLeft,  ///< Crossing.
  kFromRight,
  kElsewhere
};
struct Placement {
  Zone zone = Zone::kElsewhere;
  PathPlace place;
  double half_across_m = 0.9;  ///< Of the target, across the path.
  double turned_rad = 0.0;     ///< Direction of motion against the path's, wrapped.
};
Placement Classify(const EgoPlan& plan, const EgoBody& body, const BodyTarget& target,
                   const WarningsConfig& config);

}  // namespace v2vouch::warnings
