// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "daemon/common/models/measurement_model.h"

namespace v2vouch {

inline double Square(double a) { return a * a; }

/// Where an outline was seen, for its noise. Frame O.
struct OutlineView {
  double depth_count;         ///< Depth::count.
  double half_rad;            ///< Half of the silhouette.
  Eigen::Vector2d line_O;     ///< Unit vector from the antenna.
  Eigen::Vector2d passing_O;  ///< Velocity of the body there, relative to the antenna.
  Eigen::Vector2d lever_O;    ///< From the body's centre to the returns.
};

/// Variances of depth, middle and range rate of an outline (radar_outline.h).
Eigen::Matrix3d OutlineNoise(const EgoState& ego, const RadarConfig& radar,
                             const RadarMeasurement& z, const OutlineView& at);

}  // namespace v2vouch
