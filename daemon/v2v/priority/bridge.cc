// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/priority/bridge.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

constexpr double kSigmas = 2.0;  // Of speed and heading at the bridge's start.

}  // namespace

double BridgeBudget_s(double co_observed_s, const BridgeConfig& config) {
  return std::min(config.most_s, std::max(config.least_s, config.base_s + co_observed_s));
}

Coast::Coast(const KinematicState& seen, Timestamp stamp)
    : state_(seen),
      stamp_(stamp),
      yaw_sigma_rad_(std::sqrt(std::max(0.0, seen.covariance(kYaw, kYaw)))),
      speed_sigma_mps_(std::sqrt(std::max(0.0, seen.covariance(kSpeed, kSpeed)))) {}

void Coast::PredictTo(Timestamp stamp, const MotionNoise& motion) {
  const double dt_s = ToSeconds(stamp - stamp_);
  if (!(dt_s > 0.0)) return;
  PredictCtra(state_, dt_s, motion);
  stamp_ = stamp;
}

bool Coast::Reaches(const Eigen::Vector2d& p_O, double elapsed_s,
                    const BridgeConfig& config) const {
  const Eigen::Vector2d d = p_O - state_.mean.head<2>();
  const double c = std::cos(state_.mean[kYaw]);
  const double s = std::sin(state_.mean[kYaw]);
  const double t2 = 0.5 * elapsed_s * elapsed_s;
  const double heading_mps = yaw_sigma_rad_ * std::abs(state_.mean[kSpeed]);
  const double reach_along_m =
      config.reach_along_m + config.reach_along_mps2 * t2 + kSigmas * speed_sigma_mps_ * elapsed_s;
  const double reach_across_m =
      config.reach_across_m + config.reach_across_mps2 * t2 + kSigmas * heading_mps * elapsed_s;
  const double along = (c * d.x() + s * d.y()) / std::min(config.reach_most_m, reach_along_m);
  const double across = (-s * d.x() + c * d.y()) / std::min(config.reach_most_m, reach_across_m);
  return along * along + across * across <= 1.0;
}

void EmptyPlace::OnMiss(Timestamp stamp, double detection_probability, const BridgeConfig& config) {
  if (last_look_ && ToSeconds(stamp - *last_look_) < config.look_s) return;
  last_look_ = stamp;
  const double p_d = std::clamp(detection_probability, config.least_detection, 0.99);
  log_ratio_ += std::log(AfterMiss(1.0, p_d, config.clear_doubt, config.false_detection));
}

}  // namespace v2vouch
