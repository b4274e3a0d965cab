// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/time.h"
#include "daemon/common/base/visit.h"
#include "daemon/common/data/claim.h"
#include "daemon/common/data/track.h"
#include "daemon/common/models/ctra.h"
#include "daemon/common/models/measurement_model.h"

namespace v2vouch {

struct PriorityFilterConfig {
  MotionNoise motion;
  double bias_sigma_m = 1.5;      ///< Stationary sigma of the sender's position bias, per axis.
  double bias_decay_s = 90.0;     ///< Its Gauss-Markov time constant.
  double max_bias_m = 5.0;        ///< A larger bias is no bias.
  double speed_error_mps = 0.15;  ///< Slow error of the claimed speed.
  double yaw_error_rad = FromDegrees(1.0);  ///< Slow error of the claimed direction.
  double error_decay_s = 60.0;              ///< Time constant of both.
  double speed_sigma_mps = 0.1;             ///< White parts of a claim, beside what it says itself.
  double yaw_sigma_rad = 0.02;
  double yaw_rate_sigma_radps = 0.05;  ///< 0 is sent for "unknown" too, hence wide.
  double accel_sigma_mps2 = 0.5;
  double position_gate = 16.0;  ///< Chi-square, 2 dof: a claim beyond is not used.
  double row_gate = 9.0;        ///< Chi-square, 1 dof, for speed, direction, yaw rate, accel.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("motion", motion);
    a.Field("bias_sigma_m", bias_sigma_m, {.above = 0.0, .at_most = 5.0});
    a.Field("bias_decay_s", bias_decay_s, {.above = 1.0, .at_most = 1000.0});
    a.Field("max_bias_m", max_bias_m, {.above = 0.1, .at_most = 20.0});
    a.Field("speed_error_mps", speed_error_mps, {.above = 0.0, .at_most = 2.0});
    a.Degrees("yaw_error_deg", yaw_error_rad, {.above = 0.0, .at_most = 20.0});
    a.Field("error_decay_s", error_decay_s, {.above = 1.0, .at_most = 1000.0});
    a.Field("speed_sigma_mps", speed_sigma_mps, {.above = 0.0, .at_most = 5.0});
    a.Degrees("yaw_sigma_deg", yaw_sigma_rad, {.above = 0.0, .at_most = 30.0});
    a.Degrees("yaw_rate_sigma_degps", yaw_rate_sigma_radps, {.above = 0.0, .at_most = 60.0});
    a.Field("accel_sigma_mps2", accel_sigma_mps2, {.above = 0.0, .at_most = 10.0});
    a.Field("position_gate", position_gate, {.above = 1.0, .at_most = 100.0});
    a.Field("row_gate", row_gate, {.above = 1.0, .at_most = 100.0});
  }
};

/// How a claim fitted the filter before it was used.
struct ClaimFit {
  double position_nis = 0.0;      ///< 2 dof; bias, alignment and own covariance included.
  bool is_used = false;           ///< Position within the gate.
  bool is_velocity_used = false;  ///< Speed (and direction, where given) within theirs.
};

/// The fused filter of one PRIORITY vehicle: EKF with CTRA motion, fed by the sensor measurements
/// of its LOCAL track and by its sender's claims. Beside the vehicle's six states it carries what
/// is wrong with the claims, learnt while the sensors see the vehicle and taken off while they do
/// not:
///
///     z_position = p + b + theta J (p - p_ref)     b: sender's bias and the alignment's offset
///     z_speed    = speed + s                       s: slow error of the claimed speed
///     z_yaw      = yaw + e + theta                 e: slow error of the claimed direction
///                                                  theta: error of the alignment's yaw
///
/// b, s, e and theta are first-order Gauss-Markov; J turns by 90 degrees; p_ref is where the filter
/// started. The alignment's error is common to all senders; here it is a state of each filter with
/// the alignment's own covariance as prior, so it is never averaged away as white noise.
/// Copyable, fixed size. Axes of O, SI, radians.
class PriorityFilter {
 public:
  enum ErrorIndex { kBiasX = 6, kBiasY = 7, kSpeedError = 8, kYawError = 9, kFrameYaw = 10 };
  static constexpr int kSize = 11;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  /// @param bias and @param bias_covariance of the sender, alignment included.
  /// @param frame_yaw_sigma_rad of the alignment's yaw.
  PriorityFilter(const KinematicState& vehicle, Timestamp stamp, const Eigen::Vector2d& bias,
                 const Eigen::Matrix2d& bias_covariance, double frame_yaw_sigma_rad,
                 const PriorityFilterConfig& config);

  void PredictTo(Timestamp stamp, const PriorityFilterConfig& config);

  /// A sensor measurement linearised at kinematics().
  /// @return false where it was not used (innovation covariance not positive definite).
  bool Update(const Linearized& measurement);

  /// A claim valid at stamp().
  ClaimFit Update(const ClaimInOdometry& claim, const PriorityFilterConfig& config);

  /// Speed, direction and manoeuvre of a claim whose place is of no use.
  /// @return whether they fitted.
  bool UpdateMotion(const ClaimInOdometry& claim, const PriorityFilterConfig& config);

  /// What the position's covariance lacks to be at least `least`: the positive part of least - P.
  [[nodiscard]] Eigen::Matrix2d LackOf(const Eigen::Matrix2d& least) const;
  /// Makes the position at least as uncertain as `least`.
  void WidenPosition(const Eigen::Matrix2d& least) {
    covariance_.topLeftCorner<2, 2>() += LackOf(least);
  }

  /// Forgets some of what is known of speed and direction, so that claims can tell them anew.
  void DoubtVelocity();
  /// Takes the vehicle's state from LOCAL again and keeps what is known of the sender; for when the
  /// two have come apart although the sensors see the vehicle.
  void ResetVehicle(const KinematicState& vehicle);
  /// A new sender for the same vehicle: the errors of the claims start from their priors.
  void ResetErrors(const Eigen::Matrix2d& bias_covariance, const PriorityFilterConfig& config);

  [[nodiscard]] Timestamp stamp() const { return stamp_; }
  [[nodiscard]] KinematicState kinematics() const;
  [[nodiscard]] Eigen::Vector2d bias() const { return mean_.segment<2>(kBiasX); }
  [[nodiscard]] Eigen::Matrix2d bias_covariance() const {
    return covariance_.block<2, 2>(kBiasX, kBiasX);
  }
  /// Largest standard deviation of the position in any direction [m].
  [[nodiscard]] double position_sigma_m() const;
  /// Finite, and variances positive; false: drop the track.
  [[nodiscard]] bool is_healthy() const;
  [[nodiscard]] const Vector& mean() const { return mean_; }
  [[nodiscard]] const Matrix& covariance() const { return covariance_; }

 private:
  // Turns the state round where the claim is the same motion with the other end as the front.
  void FaceAs(const ClaimInOdometry& claim);
  bool TakeMotion(const ClaimInOdometry& claim, const PriorityFilterConfig& config);

  Timestamp stamp_{};
  Vector mean_ = Vector::Zero();
  Matrix covariance_ = Matrix::Identity();
  Eigen::Vector2d p_ref_O_ = Eigen::Vector2d::Zero();
  double frame_yaw_variance_ = 0.0;
};

}  // namespace v2vouch
