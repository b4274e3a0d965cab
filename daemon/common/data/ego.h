// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/time.h"
#include "daemon/common/frames/pose.h"

namespace v2vouch {

/// The ego car at one instant, from odometry alone.
struct EgoState {
  Timestamp stamp{};
  Pose<Odometry, Body> X_OB;
  double speed_mps = 0.0;  ///< Of the rear axle along body x.
  double yaw_rate_radps = 0.0;
  double accel_mps2 = 0.0;  ///< Along body x.
  double speed_sigma_mps = 0.1;
  double yaw_rate_sigma_radps = 0.002;
  double gyro_offset_radps = 0.0;  ///< Learnt, and taken off the yaw rate already.
  double speed_factor = 1.0;       ///< Learnt, and in the speed already.
  friend bool operator==(const EgoState&, const EgoState&) = default;
};

}  // namespace v2vouch
