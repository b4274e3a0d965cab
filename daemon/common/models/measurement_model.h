// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/base/reason.h"
#include "daemon/common/data/measurement.h"
#include "daemon/common/data/track.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// A measurement linearised at a state, whatever the sensor: innovation y = z - h(x) (angles
/// wrapped), H = dh/dx, R. Fixed upper size, so no allocation; `size` rows are in use.
struct Linearized {
  static constexpr int kMaxRows = 5;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, kStateSize, 0, kMaxRows, kStateSize>;
  using ExtentJacobian = Eigen::Matrix<double, Eigen::Dynamic, 2, 0, kMaxRows, 2>;
  using Covariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxRows>;
  Vector y;
  Jacobian H;
  /// Sensor noise, spread of the reflections, and E diag(length_sigma^2, width_sigma^2) E' for the
  /// extent that was passed in: a filter that estimates the extent itself passes sigmas of 0.
  Covariance R;
  ExtentJacobian E;  ///< dh/d(length, width); zero for a point target.
  /// dh/d(depth, aside) of the lasting offsets of radar_outline.h; no rows where there are none.
  ExtentJacobian O = ExtentJacobian(0, 2);
};

/// With a part of a vehicle unseen, the mean of the rest is displaced, by up to half of its own
/// length; the same part stays unseen from scan to scan: so many scans count as one.
inline constexpr double kUnseenLooks = 8.0;
/// Corners are round: 1 sigma of where a radar has the edge of a silhouette.
inline constexpr double kRadarEdgeSigma_m = 0.25;

/// Where the centre of mass of a vehicle's radar reflections lies, as seen from a sensor: offset
/// from the footprint's centre in the vehicle's own axes. Faces weigh by the angle under which the
/// sensor sees them, in perspective: a face seen edge-on or from behind its plane counts nothing.
///
///     A = (|cos a| - L / 2r)+ W / df^2  (front or rear),  B = (|sin a| - W / 2r)+ L / ds^2  (side)
///     offset = ( A sgn(cos a) L / 2,  B sgn(sin a) W / 2 ) / (A + B)
///
/// with a the direction from the vehicle to the sensor in vehicle axes, r the distance, df and ds
/// those of the faces' middles in units of r; (.)+ and sgn are smoothed over about a degree, so
/// that the Jacobian exists everywhere.
/// @param p_OS the sensor seen from the centre, expressed in O [m].
/// @param forward_O the vehicle's direction as a unit vector in O.
Eigen::Vector2d ReflectionOffset(const Eigen::Vector2d& p_OS, const Eigen::Vector2d& forward_O,
                                 const Extent& extent);
Eigen::Vector2d ReflectionOffset(const Eigen::Vector2d& p_OS, double yaw_rad, const Extent& extent);

/// Velocity of a radar's antenna over ground, axes of B: rear axle plus yaw rate x lever arm.
Eigen::Vector2d AntennaVelocity_B(const EgoState& ego, const RadarConfig& radar);
/// The ego's own motion is measured too: variances that the noise of its speed and of its yaw rate
/// give a range rate along `line_B`.
Eigen::Vector2d EgoMotionVariances(const EgoState& ego, const RadarConfig& radar,
                                   const Eigen::Vector2d& line_B);

/// Extent-aware radar model.
///
///     h(x) = [ |q|, atan2(q_y, q_x), range rate of q relative to the moving antenna ]
///
/// with q the expected centre of mass of the reflections (ReflectionOffset) in the radar's frame R;
/// q moves with the vehicle's speed and yaw rate x offset, the antenna with the ego's speed, yaw
/// rate and lever arm. R adds to the measurement's own covariance: the spread of reflections over
/// the visible faces divided by their number, a share of it that does not average out, and the
/// ego's speed and yaw-rate noise; where visible_share < 1, what the unseen part may shift the mean
/// by, as a lasting error. Extent {0, 0} is an ideal point target.
/// @return nullopt when the target is closer than 0.1 m to the antenna.
std::optional<Linearized> LinearizeRadar(const StateVector& x, const Extent& extent,
                                         const EgoState& ego, const RadarConfig& radar,
                                         const RadarMeasurement& measurement);

/// Camera model, all angles in the levelled camera frame (x ahead, y left):
///
///     h(x) = [ largest bearing of a corner, smallest bearing of a corner,
///              atan(z_camera cos(b) / smallest x of a corner) ]
///
/// with b the bearing of the box's middle, under which its bottom edge was turned into a
/// depression. A cut edge drops its row; the other edge is then trusted less. A point target has
/// one bearing, the middle of the box.
/// @return nullopt when the target is not wholly ahead of the image plane or no row is usable.
std::optional<Linearized> LinearizeCamera(const StateVector& x, const Extent& extent,
                                          const EgoState& ego, const CameraConfig& camera,
                                          const CameraMeasurement& measurement);

/// A position in O measured directly (lidar, simulation).
Linearized LinearizePosition(const StateVector& x, const Eigen::Vector2d& p_O,
                             const Eigen::Matrix2d& noise);

/// A whole pose measured directly. As many rows as PoseMeasurement has, known to the compiler:
///
///     h(x) = [x, y, yaw, speed, yaw rate],   H = [I 0],   y = z - h(x), yaw wrapped
struct LinearizedPose {
  static constexpr int kRows = 5;
  using Vector = Eigen::Matrix<double, kRows, 1>;
  using Covariance = Eigen::Matrix<double, kRows, kRows>;
  Vector y;
  Covariance R;
};
LinearizedPose LinearizePose(const StateVector& x, const PoseMeasurement& measurement);

/// A box on the ground measured in O.
///
///     h(x) = [x, y, yaw (or yaw + pi), vx, vy],   (vx, vy) = speed (cos yaw, sin yaw)
///
/// Rows that the box has no figure for, or whose figure cannot belong to this state, are left out:
/// the axis where it is turned by more than kOddAxis_rad (detectors turn one box in twenty by a
/// quarter), the velocity where it is unknown.
Linearized LinearizeBox(const StateVector& x, const BoxMeasurement& measurement);
inline constexpr double kOddAxis_rad = 0.6;
/// Its velocity's two rows alone; only where it tells one.
Linearized LinearizeBoxVelocity(const StateVector& x, const BoxMeasurement& measurement);

/// Difference of two axes, in (-pi/2, pi/2].
double AxisDifference(double a_rad, double b_rad);

/// Why a pose cannot be used: kNotFinite; kOutOfRange where a value lies beyond kMaxPosition_m or
/// kMaxSpeed_mps, or the covariance is not symmetric and positive definite. nullopt: usable.
std::optional<Reason> FaultOf(const PoseMeasurement& measurement);
/// Likewise a box; sizes and standard deviations must be positive, too.
std::optional<Reason> FaultOf(const BoxMeasurement& box);
inline constexpr double kMaxPosition_m = 1e6;
inline constexpr double kMaxSpeed_mps = 150.0;

/// Joseph-form EKF update. Covariance stays symmetric and positive semidefinite; yaw is wrapped.
/// @return false when the innovation covariance is not positive definite or the result is not
///   finite; state untouched.
bool UpdateWith(const Linearized& measurement, KinematicState& state);

/// Squared Mahalanobis distance of the innovation and log-determinant of its covariance.
struct Likelihood {
  double distance_squared = 0.0;
  double log_det = 0.0;
  int rows = 0;
};
std::optional<Likelihood> Evaluate(const Linearized& measurement, const StateMatrix& covariance);

}  // namespace v2vouch
