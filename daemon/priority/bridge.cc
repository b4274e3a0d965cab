// SPDX-License-Identifier: Apache-2.0
#include "daemon/priority/bridge.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {

double BridgeBudget_s(double co_observed_s, const BridgeConfig& config) {
  return std::min(config.most_s, std::max(config.least_s, config.base_s + co_observed_s));
}

bool IsReachable(const KinematicState& coast, double elapsed_s, const Eigen::Vector2d& p_O,
                 const BridgeConfig& config) {
  const Eigen::Vector2d d = p_O - coast.mean.head<2>();
  const double c = std::cos(coast.mean[kYaw]);
  const double s = std::sin(coast.mean[kYaw]);
  const double t2 = 0.5 * elapsed_s * elapsed_s;
  const double along =
      (c * d.x() + s * d.y()) / (config.reach_along_m + config.reach_along_mps2 * t2);
  const double across =
      (-s * d.x() + c * d.y()) / (config.reach_across_m + config.reach_across_mps2 * t2);
  return along * along + across * across <= 1.0;
}

void EmptyPlace::OnMiss(Timestamp stamp, double detection_probability, const BridgeConfig& config) {
  if (last_look_ && ToSeconds(stamp - *last_look_) < config.look_s) return;
  last_look_ = stamp;
  const double p_d = std::clamp(detection_probability, config.least_detection, 0.99);
  log_ratio_ += std::log((1.0 - p_d) / (1.0 - config.false_detection));
}

}  // namespace v2vouch
