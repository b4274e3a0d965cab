// SPDX-License-Identifier: Apache-2.0
// What drives on roads; for extent.cc and extent_change.cc only.
#pragma once

#include <algorithm>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/extent.h"

namespace v2vouch {

inline constexpr double kMinSize_m = 0.3;
inline constexpr double kMaxLength_m = 25.0;
inline constexpr double kMaxWidth_m = 4.0;

/// Keeps length and width within what drives on roads, and wraps yaw.
inline void ClampExtended(ExtendedState& state) {
  double& length = state.mean[ExtendedState::kLength];
  double& width = state.mean[ExtendedState::kWidth];
  length = std::clamp(length, kMinSize_m, kMaxLength_m);
  width = std::clamp(width, kMinSize_m, kMaxWidth_m);
  state.mean[kYaw] = WrapAngle(state.mean[kYaw]);
}

}  // namespace v2vouch
