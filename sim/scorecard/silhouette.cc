// SPDX-License-Identifier: Apache-2.0
#include "sim/scorecard/silhouette.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::evaluation {

Silhouette SilhouetteOf(const Footprint& box, const Eigen::Vector2d& from) {
  Silhouette silhouette;
  const Eigen::Vector2d line = box.centre - from;
  silhouette.range_m = line.norm();
  if (box.DistanceTo(from) <= 0.0) {
    silhouette.half_width_rad = kPi;
    return silhouette;
  }
  const double centre_rad = std::atan2(line.y(), line.x());
  double low = 0.0, high = 0.0;
  for (const Eigen::Vector2d& corner : box.Corners()) {
    const Eigen::Vector2d to = corner - from;
    const double off = WrapAngle(std::atan2(to.y(), to.x()) - centre_rad);
    low = std::min(low, off);
    high = std::max(high, off);
  }
  silhouette.middle_rad = WrapAngle(centre_rad + 0.5 * (low + high));
  silhouette.half_width_rad = 0.5 * (high - low);
  return silhouette;
}

std::vector<double> UncoveredShares(const std::vector<Silhouette>& silhouettes) {
  std::vector<double> shares;
  std::vector<std::pair<double, double>> covered;  // Relative to the silhouette's middle.
  for (const Silhouette& target : silhouettes) {
    const double half = target.half_width_rad;
    covered.clear();
    for (const Silhouette& other : silhouettes) {
      if (&other == &target || other.range_m >= target.range_m) continue;
      const double off = WrapAngle(other.middle_rad - target.middle_rad);
      const double from = std::max(-half, off - other.half_width_rad);
      const double to = std::min(half, off + other.half_width_rad);
      if (to > from) covered.emplace_back(from, to);
    }
    std::ranges::sort(covered);
    double hidden = 0.0;
    double reached = -half;
    for (const auto& [from, to] : covered) {
      hidden += std::max(0.0, to - std::max(from, reached));
      reached = std::max(reached, to);
    }
    shares.push_back(half > 0.0 ? 1.0 - hidden / (2.0 * half) : 1.0);
  }
  return shares;
}

}  // namespace v2vouch::evaluation
