// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "daemon/warnings/conflict.h"
#include "daemon/warnings/warning.h"
#include "daemon/warnings/warnings_config.h"

namespace v2vouch::warnings {

/// Everything that one decision rests on, at one time.
struct Scene {
  Timestamp now{};
  EgoReading ego;
  std::optional<EgoIntent> intent;  ///< Fresh ones only.
  Eigen::Vector2d ego_p_O = Eigen::Vector2d::Zero();
  double ego_yaw_O = 0.0;
  std::vector<Target> targets;  ///< One per physical vehicle, predicted to `now`.
};

/// Joins the lists: one object per physical vehicle. A PRIORITY track that rests on a LOCAL one is
/// that vehicle. Where own sensors see it now, its state is LOCAL's, which no message can change;
/// hidden or out of view it is PRIORITY's. Ordered by LOCAL id, then PRIORITY id.
std::vector<Target> MergeLists(const TargetList* local, const TargetList* priority, Timestamp now);

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

/// What one vehicle amounts to for one kind, in this instant alone: no memory.
struct Assessment {
  Warning warning;                     ///< `level` as the condition has it now; no `since`.
  Level level_if_sure = Level::kInfo;  ///< The same with existence 1: holds an URGENT up.
};

/// Kinds that apply, for all vehicles; levels from ADVISE on.
std::vector<Assessment> Assess(const Scene& scene, const EgoBody& body,
                               const WarningsConfig& config);

}  // namespace v2vouch::warnings
