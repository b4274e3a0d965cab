// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/data/ego.h"
#include "daemon/common/data/measurement.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// One radar or camera together with the ego's state at its frame; both outlive it.
struct RadarLook {
  RadarLook(const EgoState& ego_state, const RadarConfig& config);
  const EgoState& ego;
  const RadarConfig& radar;
  [[nodiscard]] const Eigen::Vector2d& origin_O() const { return origin_O_; }

 private:
  Eigen::Vector2d origin_O_;  // Every pair asks for it.
};
struct CameraLook {
  CameraLook(const EgoState& ego_state, const CameraConfig& config);
  const EgoState& ego;
  const CameraConfig& camera;
  [[nodiscard]] const Eigen::Vector2d& origin_O() const { return origin_O_; }

 private:
  Eigen::Vector2d origin_O_;
};

/// A bottom edge so far below the horizon stands right before the car: 6.6 m from a camera at 1.34
/// m.
inline constexpr double kRightBefore_rad = 0.2;

/// Where a measurement alone puts the reflecting point, with its covariance, in O [m].
struct Fix {
  Eigen::Vector2d p_O = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
};
Fix FixOf(const RadarLook& look, const RadarMeasurement& measurement);
/// nullopt where the box has no usable bottom edge or bearing, or lies on the horizon. A bottom
/// that the lower end of the picture cuts off, right before the car, is a bound: anywhere nearer.
std::optional<Fix> FixOf(const CameraLook& look, const CameraMeasurement& measurement);

/// Whether the picture's lower end cuts the box off right before the car, so that something that
/// begins `range_m` from the camera, much farther than where it is cut, cannot be what it shows.
bool IsBeyondCut(const CameraLook& look, const CameraMeasurement& measurement, double range_m);

}  // namespace v2vouch
