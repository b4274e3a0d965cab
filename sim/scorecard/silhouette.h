// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/metrics/footprint.h"

namespace v2vouch::evaluation {

/// Directions that a box covers, seen from a point of the same plane.
struct Silhouette {
  double middle_rad = 0.0;
  double half_width_rad = 0.0;  ///< pi where the point is inside the box.
  double range_m = 0.0;         ///< From the point to the box's centre.
};
Silhouette SilhouetteOf(const Footprint& box, const Eigen::Vector2d& from);

/// Share of each silhouette that no nearer one covers, 0..1, all seen from one point. Flat: a lorry
/// seen over a car's roof counts as covered by the car. Nearer is by the range of the centres.
std::vector<double> UncoveredShares(const std::vector<Silhouette>& silhouettes);

}  // namespace v2vouch::evaluation
