// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>

#include "daemon/common/base/time.h"
#include "daemon/common/data/ego.h"
#include "daemon/common/frames/pose.h"

namespace v2vouch {

/// One GNSS fix with everything turned into the axes of L.
struct FixInPlane {
  Eigen::Vector2d p_L = Eigen::Vector2d::Zero();             ///< Antenna.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< Of p_L, floored.
  std::optional<Eigen::Vector2d> v_L;                        ///< Velocity of the antenna.
  double velocity_sigma_mps = 0.2;
  std::optional<double> yaw_L_rad;  ///< Of the body's x axis.
  double yaw_sigma_rad = 0.01;
};

/// Random parts of the alignment's drift, and what the measurements are worth.
struct AlignmentNoise {
  double drift_per_m = 0.0;
  double yaw_drift_per_s = 0.0;
  double min_course_speed_mps = 3.0;
};

/// EKF over where O lies in L, kept at the car instead of at O's origin: a yaw error then turns the
/// world about the car, which is what odometry drift does, and position and yaw stay well
/// conditioned however far the car has driven.
///
///     state = [east, north of the body origin; yaw of O in L; drift rate of that yaw;
///              scale error of the odometry's distance]
///     p' = p + (1 + scale) R(yaw) d_O,   yaw' = yaw + drift dt
///     antenna = p + R(yaw) R_OB a_B,     course = yaw + yaw_OB + atan2(w a_x, v - w a_y)
///
/// Fix errors are coloured: each fix weighs as one sample of a process with a correlation time, so
/// that ten fixes a second are not taken for ten independent ones.
class AlignmentFilter {
 public:
  enum Index { kEast = 0, kNorth = 1, kYaw = 2, kYawDrift = 3, kScale = 4, kSize = 5 };
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  AlignmentFilter() = default;
  /// Starts from one fix and a yaw of O in L.
  AlignmentFilter(const FixInPlane& fix, double yaw_LO_rad, double yaw_sigma_rad,
                  const Eigen::Vector2d& antenna_B, const EgoState& ego);

  /// Carries the state to `ego`, by what the odometry says has happened since. At standstill the
  /// car's own pose in L is held, whatever O does.
  void Predict(const EgoState& ego, const AlignmentNoise& noise);
  /// Distance of the fix from the prediction, beyond `jump_m` and four sigma; or course or heading
  /// far from the predicted one. @return the fields of gnss_fix_t that contradict; "" = none does.
  [[nodiscard]] std::string_view Contradiction(const FixInPlane& fix,
                                               const Eigen::Vector2d& antenna_B,
                                               const EgoState& ego, const AlignmentNoise& noise,
                                               double jump_m) const;
  /// Takes a fix in. Call Predict to the same instant before.
  void Update(const FixInPlane& fix, const Eigen::Vector2d& antenna_B, const EgoState& ego,
              const AlignmentNoise& noise);
  /// The same state in another plane: position moved to `p_L`, axes turned by `turn_rad`.
  void Rebase(const Eigen::Vector2d& p_L, double turn_rad);
  /// Takes the odometry's errors (drift rate, scale) over from another filter.
  void InheritOdometryErrors(const AlignmentFilter& other);

  [[nodiscard]] Pose<LocalEnu, Odometry> X_LO() const;
  [[nodiscard]] Eigen::Vector2d body_L() const { return mean_.head<2>(); }
  [[nodiscard]] double yaw_rad() const { return mean_(kYaw); }
  [[nodiscard]] double yaw_drift_radps() const { return mean_(kYawDrift); }
  [[nodiscard]] double scale() const { return mean_(kScale); }
  [[nodiscard]] Eigen::Vector2d body_O() const { return X_OB_.origin().vector(); }
  /// Of [east, north of the body origin, yaw].
  [[nodiscard]] Eigen::Matrix3d PoseCovariance() const { return covariance_.topLeftCorner<3, 3>(); }
  [[nodiscard]] bool IsSound() const;

  static bool IsStanding(const EgoState& ego);
  /// The yaw of O in L that the fix' course over ground means, where the car is fast enough.
  static std::optional<double> YawFromCourse(const FixInPlane& fix,
                                             const Eigen::Vector2d& antenna_B, const EgoState& ego,
                                             double min_speed_mps);
  static double CourseSigma(const FixInPlane& fix, const EgoState& ego);
  /// Of the antenna in B: the car turns about its rear axle.
  static Eigen::Vector2d AntennaVelocity_B(const Eigen::Vector2d& antenna_B, const EgoState& ego);
  /// How many fixes `interval_s` apart are worth one.
  static double ColourOfPositions(double interval_s);
  static double ColourOfVelocities(double interval_s);

 private:
  void UpdateYaw(double yaw_LO_rad, double variance);

  Vector mean_ = Vector::Zero();
  Matrix covariance_ = Matrix::Identity();
  Pose<Odometry, Body> X_OB_;
  double gyro_offset_radps_ = 0.0;  // As taken off in odometry,
  double speed_factor_ = 1.0;       // and as corrected in it: what is left is estimated here.
  Timestamp stamp_{};
  Timestamp last_update_{};
};

}  // namespace v2vouch
