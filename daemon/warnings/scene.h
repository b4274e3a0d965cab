// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "daemon/common/data/input.h"
#include "daemon/common/data/track.h"

namespace v2vouch::warnings {

/// Which of the two lists holds a vehicle; values are those of warning_t.
enum class Source : std::int8_t { kLocal = 1, kPriority = 2, kBoth = 3 };

/// One vehicle as a list tells of it. The state is in O, as the lists have it.
struct Target {
  KinematicState state_O;
  std::int64_t track_id = 0;  ///< Of PRIORITY; 0 = not there.
  std::int64_t local_id = 0;  ///< Of LOCAL; 0 = not there.
  double existence = 1.0;
  Timestamp last_own{};           ///< Measured by an own sensor; 1970 = never.
  double bridge_budget_s = kNaN;  ///< Of PRIORITY; NaN = not applicable.
  Extent extent;
  Source source = Source::kLocal;
  ObjectClass object_class = ObjectClass::kUnknown;
  Visibility visibility = Visibility::kVisible;
  /// Faster than a vehicle can become since it was listed at a walk: a track that has slipped to
  /// something else. Set by the Warner.
  bool is_sudden = false;
  bool says_hard_braking = false;  ///< Its vouched sender reports more than 0.4 g. PRIORITY only.
};

/// A track list as far as a warning needs it.
struct TargetList {
  Timestamp stamp{};
  std::int64_t seq = -1;
  bool is_stale = false;
  bool is_gnss_suspect = false;
  Eigen::Vector2d ego_p_O = Eigen::Vector2d::Zero();  ///< Rear axle.
  double ego_yaw_O = 0.0;
  std::vector<SectorHealth> sectors;
  std::vector<Target> targets;
};

/// The ego's motion as EGO_MOTION tells it.
struct EgoReading {
  Timestamp stamp{};
  double speed_mps = 0.0;
  double speed_sigma_mps = 0.1;
  double yaw_rate_radps = 0.0;
  double yaw_rate_sigma_radps = 0.005;
  double accel_mps2 = 0.0;
};

enum class TurnSignal : std::int8_t { kNone = 0, kLeft = 1, kRight = 2, kUnknown = 7 };

/// What the driver or planner is about to do (ego_intent_t).
struct EgoIntent {
  Timestamp stamp{};
  TurnSignal turn_signal = TurnSignal::kUnknown;
  bool is_braking = false;
  double accel_request_mps2 = kNaN;
  std::vector<Eigen::Vector2d>
      path_B;  ///< Rear axle's, in the body frame at `stamp`; empty = none.
};

}  // namespace v2vouch::warnings
