// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/data/measurement.h"
#include "daemon/data/track.h"
#include "daemon/data/vehicle.h"

namespace v2vouch {

/// A measurement linearised at a state, whatever the sensor: innovation y = z - h(x) (angles
/// wrapped), H = dh/dx, R. Fixed upper size, so no allocation; `size` rows are in use.
struct Linearized {
  static constexpr int kMaxRows = 4;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, kStateSize, 0, kMaxRows, kStateSize>;
  using Covariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxRows>;
  Vector y;
  Jacobian H;
  Covariance R;
};

/// Extent-aware radar model: which point of the footprint a cluster's reference stands for, given
/// aspect and extent, and how unsure that is (added to R).
///
///     h(x) = [ |q|, atan2(q_y, q_x), range rate of q relative to the moving antenna ]
///
/// with q the expected reflection point of the visible faces in the radar's frame R; the antenna
/// moves with the ego's speed, yaw rate and lever arm. Extent {0, 0} is an ideal point target.
/// @return nullopt when the target is closer than 0.1 m to the antenna.
std::optional<Linearized> LinearizeRadar(const StateVector& x, const Extent& extent,
                                         const EgoState& ego, const RadarConfig& radar,
                                         const RadarMeasurement& measurement);

/// Camera model: bearings of the silhouette's edges (or of the centre, when an edge is cut) and
/// depression of the nearest ground contact, all angles in the levelled camera frame.
/// @return nullopt when the target is behind the image plane or nothing of the box is usable.
std::optional<Linearized> LinearizeCamera(const StateVector& x, const Extent& extent,
                                          const EgoState& ego, const CameraConfig& camera,
                                          const CameraMeasurement& measurement);

/// Joseph-form EKF update of any state whose first kStateSize entries are the vehicle's.
/// @return false when the innovation covariance is not positive definite; state untouched.
bool UpdateWith(const Linearized& measurement, KinematicState& state);

/// Squared Mahalanobis distance of the innovation and log-determinant of its covariance.
struct Likelihood {
  double distance_squared = 0.0;
  double log_det = 0.0;
  int rows = 0;
};
std::optional<Likelihood> Evaluate(const Linearized& measurement, const StateMatrix& covariance);

}  // namespace v2vouch
