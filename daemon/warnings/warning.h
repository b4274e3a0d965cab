// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "daemon/warnings/scene.h"

namespace v2vouch::warnings {

// Values of all of these are those of warning_t and warning_list_t.
enum class Kind : std::int8_t { kFcw = 1, kEebl = 2, kIma = 3, kLta = 4, kBsw = 5, kLcw = 6 };
enum class Level : std::int8_t { kInfo = 0, kAdvise = 1, kWarn = 2, kUrgent = 3, kLost = 4 };
enum class Side : std::int8_t {
  kAhead = 0,
  kLeft = 1,
  kRight = 2,
  kRearLeft = 3,
  kRearRight = 4,
  kOncoming = 5
};
enum class Basis : std::int8_t {
  kProbability = 1,
  kReachable = 2,
  kGap = 3,
  kBraking = 4,
  kBeside = 5,
  kHeld = 6,
  kEnded = 7
};
enum Degraded : std::int32_t {
  kNoPriority = 1,
  kGnssSuspect = 2,
  kSectorsMissing = 4,
  kListsStale = 8,
  kNoEgo = 16,
  kNoIntent = 32
};
inline constexpr std::int32_t kAllKinds = 0b1111110;
constexpr std::int32_t Bit(Kind kind) { return 1 << static_cast<int>(kind); }
const char* KindName(Kind kind);     ///< "FCW", ...
const char* LevelName(Level level);  ///< "ADVISE", ...

/// What a level rests on, in numbers; NaN = not applicable. Body frame now.
struct Figures {
  double conflict_probability = kNaN;
  double time_to_conflict_s = kNaN;
  double time_to_conflict_early_s = kNaN;
  double post_encroachment_s = kNaN;
  double required_decel_mps2 = kNaN;
  double warn_before_s = kNaN;
  double urgent_before_s = kNaN;
  Eigen::Vector2d conflict_B{kNaN, kNaN};
  Eigen::Vector2d position_B{kNaN, kNaN};
  double speed_mps = kNaN;
  double existence = kNaN;
  double own_sensor_age_s = kNaN;
  double bridge_budget_s = kNaN;
};

struct Warning {
  std::int64_t track_id = 0;
  std::int64_t local_id = 0;
  Kind kind = Kind::kFcw;
  Level level = Level::kAdvise;
  Side side = Side::kAhead;
  Source source = Source::kLocal;
  Visibility visibility = Visibility::kVisible;
  Basis basis = Basis::kProbability;
  Timestamp since{};
  Figures figures;
};

struct WarningList {
  Timestamp stamp{};
  std::int64_t seq = 0;
  std::int64_t local_seq = -1;
  std::int64_t priority_seq = -1;
  std::int32_t available_kinds = 0;
  std::int32_t degraded = 0;
  std::vector<Warning> warnings;  ///< Most urgent first, then the earliest conflict.
};

}  // namespace v2vouch::warnings
