// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/warnings/conflict.h"
#include "daemon/warnings/warning.h"
#include "daemon/warnings/warnings_config.h"

namespace v2vouch::warnings {

/// A vehicle slower than this stands: no direction of motion is taken from it.
inline constexpr double kTargetStands_mps = 1.0;

/// A listed vehicle in the body frame of an ego at `ego_p_O`, `ego_yaw_O`. Where no list claims to
/// know its axis (sigma of the heading above 0.5 rad) its size is that of its middle, which is
/// there along every axis.
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

/// A vehicle that drives in or beside the path as one that keeps its lane: along the path, turning
/// as it does, wandering by 0.25 m/s. One that comes nearer to the path, or leaves it, by more than
/// 0.8 m/s across it is changing lanes and stays as it is; slower, the error of a heading at speed
/// looks the same.
BodyTarget InItsLane(const EgoPlan& plan, const BodyTarget& target, const Placement& placement);

/// An oncoming vehicle as one that keeps its lane along the path that both drive, laid out
/// straight: x along the path, y left of it. So a bend that both follow makes no conflict. None
/// where it moves across the path by more than 0.8 m/s.
std::optional<BodyTarget> ComingInItsLane(const BodyTarget& target, const Placement& placement);

/// A crossing vehicle, with what is known of cars that cross beside what the track knows: most
/// drive straight on at an even speed. One that shows a turn or braking stays as it is.
BodyTarget Steadied(const BodyTarget& target);

/// Beside the path, and part of it beside the ego already: no braking of ours is for it.
bool IsAlongside(const EgoBody& body, const BodyTarget& target, const Placement& placement);

Placement Classify(const EgoPlan& plan, const EgoBody& body, const BodyTarget& target,
                   const WarningsConfig& config);

}  // namespace v2vouch::warnings
