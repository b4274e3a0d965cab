// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

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

/// What one vehicle amounts to for one kind, in this instant alone: no memory.
struct Assessment {
  Warning warning;                     ///< `level` as the condition has it now; no `since`.
  Level level_if_sure = Level::kInfo;  ///< The same with existence 1: holds an URGENT up.
};

/// Kinds that apply, for all vehicles; levels from ADVISE on.
std::vector<Assessment> Assess(const Scene& scene, const EgoBody& body,
                               const WarningsConfig& config);

}  // namespace v2vouch::warnings
