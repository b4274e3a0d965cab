// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/models/outline_noise.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/models/radar_outline.h"

namespace v2vouch {
namespace {

// By which strong returns scatter about their mean depth behind the outline.
constexpr double kDepthSigma_m = 0.3;
// Share of half a silhouette by which the mean of one scan misses its middle, at best.
constexpr double kMiddleShare = 0.3;
// Wheels and a turn that has just begun.
constexpr double kRateSigma_mps = 0.1;
constexpr double kYawRateDoubt_radps = 0.05;

}  // namespace

Eigen::Matrix3d OutlineNoise(const EgoState& ego, const RadarConfig& radar,
                             const RadarMeasurement& z, const OutlineView& at) {
  const double n = std::max(z.returns, 1);
  const double n_outline = static_cast<double>(z.outline_count);
  Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
  R(0, 0) = (Square(radar.range_sigma_m) + Square(kDepthSigma_m)) / at.depth_count;
  const double unseen = std::clamp(1.0 - z.visible_share, 0.0, 1.0);
  R(1, 1) = Square(radar.azimuth_sigma_rad) / n +
            Square(at.half_rad) *
                (std::max(1.0 / (3.0 * n), Square(kMiddleShare)) + kUnseenLooks * unseen * unseen);
  const Eigen::Vector2d across(-at.line_O.y(), at.line_O.x());
  const double passing_mps = across.x() * at.passing_O.x() + across.y() * at.passing_O.y();
  const double lever_m = across.x() * at.lever_O.x() + across.y() * at.lever_O.y();
  const Eigen::Vector2d line_B = ego.X_OB.rotation().transpose() * at.line_O;
  const Eigen::Vector2d from_ego = EgoMotionVariances(ego, radar, line_B);
  R(2, 2) = (Square(radar.range_rate_sigma_mps) + Square(kRateSigma_mps) +
             Square(passing_mps * radar.azimuth_sigma_rad)) /
                n_outline +
            Square(kYawRateDoubt_radps * lever_m) + from_ego[0] + from_ego[1];
  R(2, 2) = std::max(R(2, 2), z.covariance(2, 2));
  return R;
}

}  // namespace v2vouch
