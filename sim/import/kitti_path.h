// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/import/kitti.h"

namespace v2vouch::sim {

inline constexpr std::int64_t kFrame_us = 100'000;  ///< KITTI's frames come at 10 Hz.
inline constexpr double kFrame_s = 0.1;
inline constexpr std::int64_t kMotion_us = 20'000;  ///< Of the ego motion made from them.

struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

/// Speed and yaw rate between frames, linear.
KittiMotion MotionAt(const std::vector<KittiMotion>& motion, double frame);

/// Poses at the frames, by the middle of each 20 ms piece.
std::vector<Pose2> Integrated(const std::vector<KittiMotion>& motion);

}  // namespace v2vouch::sim
