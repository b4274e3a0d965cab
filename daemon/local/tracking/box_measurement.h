// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/base/reason.h"

namespace v2vouch {

/// One vehicle as a detector of boxes sees it (lidar network, smart camera), in O. It knows place,
/// axis and size, but no velocity: that is the tracker's to learn.
struct BoxMeasurement {
  double x_m = 0.0;  ///< Of the footprint's centre.
  double y_m = 0.0;
  double yaw_rad = 0.0;  ///< Of the axis; front and rear may be confused.
  double length_m = 4.0;
  double width_m = 1.7;
  Eigen::Matrix2d position_covariance = Eigen::Matrix2d::Identity();  ///< [m^2], in O.
  double yaw_sigma_rad = 0.15;
  double length_sigma_m = 0.4;
  double width_sigma_m = 0.15;
  /// What the detector's score says: ln p(score | vehicle) / p(score | clutter); 0: nothing.
  double log_odds = 0.0;
};

/// Why a box cannot be used: kNotFinite; kOutOfRange where a position is beyond kMaxPosition_m, a
/// size or a standard deviation is not positive, or the covariance is not positive definite.
std::optional<Reason> FaultOf(const BoxMeasurement& box);

}  // namespace v2vouch
