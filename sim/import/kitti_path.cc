// SPDX-License-Identifier: Apache-2.0
#include "sim/import/kitti_path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace v2vouch::sim {

KittiMotion MotionAt(const std::vector<KittiMotion>& motion, double frame) {
  const double last = static_cast<double>(motion.size()) - 1.0;
  const double at = std::clamp(frame, 0.0, last);
  const auto before = static_cast<std::size_t>(at);
  const std::size_t after = std::min(before + 1, motion.size() - 1);
  const double u = at - static_cast<double>(before);
  const auto between = [u](double a, double b) { return a + u * (b - a); };
  return {between(motion[before].speed_mps, motion[after].speed_mps),
          between(motion[before].yaw_rate_radps, motion[after].yaw_rate_radps), true};
}

std::vector<Pose2> Integrated(const std::vector<KittiMotion>& motion) {
  constexpr int kPieces = static_cast<int>(kFrame_us / kMotion_us);
  std::vector<Pose2> poses(motion.size());
  Pose2 pose;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    poses[k] = pose;
    for (int i = 0; i < kPieces; ++i) {
      const KittiMotion now =
          MotionAt(motion, static_cast<double>(k) + (i + 0.5) / static_cast<double>(kPieces));
      const double piece_s = kFrame_s / kPieces;
      const double yaw = pose.yaw_rad + 0.5 * piece_s * now.yaw_rate_radps;
      pose.x_m += piece_s * now.speed_mps * std::cos(yaw);
      pose.y_m += piece_s * now.speed_mps * std::sin(yaw);
      pose.yaw_rad += piece_s * now.yaw_rate_radps;
    }
  }
  return poses;
}

}  // namespace v2vouch::sim
