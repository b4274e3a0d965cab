// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"
#include "daemon/common/data/ego.h"
#include "daemon/common/data/input.h"
#include "daemon/v2v/alignment/alignment.h"

namespace v2vouch {

/// What is wrong with a simulated car's odometry and GNSS receiver.
struct DriveErrors {
  double speed_scale = 0.0;          ///< Odometry speed = true speed * (1 + this).
  double yaw_rate_bias_radps = 0.0;  ///< Added to the odometry's yaw rate, also at standstill.
  Eigen::Vector2d bias_en = Eigen::Vector2d::Zero();
  double markov_sigma_m = 0.0;  ///< First-order Gauss-Markov, per axis.
  double markov_time_s = 30.0;
  double white_sigma_m = 0.0;
  double velocity_sigma_mps = 0.0;
};

/// A car on the true earth beside the odometry frame that its own odometry makes of the drive.
class SimulatedDrive {
 public:
  SimulatedDrive(const Wgs84& start, double yaw_en_rad, const DriveErrors& errors,
                 std::uint64_t seed = 1)
      : plane_(start), yaw_(yaw_en_rad), errors_(errors), random_(seed) {
    for (int axis = 0; axis < 2; ++axis) markov_(axis) = random_.Normal(0.0, errors.markov_sigma_m);
  }

  /// Drives on for `dt_s` at a steady speed and yaw rate, in steps of at most 10 ms.
  void Advance(double speed_mps, double yaw_rate_radps, double dt_s) {
    const int steps = static_cast<int>(std::ceil(dt_s / 0.01 - 1e-9));
    const double dt = dt_s / steps;
    for (int i = 0; i < steps; ++i) {
      Step(position_, yaw_, speed_mps, yaw_rate_radps, dt);
      Step(odometry_, odometry_yaw_, speed_mps * (1.0 + errors_.speed_scale),
           yaw_rate_radps + errors_.yaw_rate_bias_radps, dt);
    }
    const double decay = std::exp(-dt_s / errors_.markov_time_s);
    for (int axis = 0; axis < 2; ++axis) {
      markov_(axis) = decay * markov_(axis) +
                      random_.Normal(0.0, errors_.markov_sigma_m * std::sqrt(1.0 - decay * decay));
    }
    time_s_ += dt_s;
    speed_ = speed_mps;
    yaw_rate_ = yaw_rate_radps;
  }

  [[nodiscard]] EgoState Ego() const {
    EgoState ego;
    ego.stamp = Now();
    ego.X_OB = {odometry_.x(), odometry_.y(), odometry_yaw_};
    ego.speed_mps = speed_ * (1.0 + errors_.speed_scale);
    ego.yaw_rate_radps = yaw_rate_ + errors_.yaw_rate_bias_radps;
    ego.gyro_offset_radps = learnt_bias_radps_;
    ego.speed_factor = learnt_factor_;
    return ego;
  }

  /// From now on odometry takes off its yaw rate bias and scales its speed to the true one.
  void LearnOdometry() {
    learnt_bias_radps_ = errors_.yaw_rate_bias_radps;
    learnt_factor_ = 1.0 / (1.0 + errors_.speed_scale);
    errors_.yaw_rate_bias_radps = 0.0;
    errors_.speed_scale = 0.0;
  }

  /// A fix of this moment, with velocity and without heading.
  [[nodiscard]] GnssFix Fix(const VehicleConfig& vehicle) {
    const double c = std::cos(yaw_);
    const double s = std::sin(yaw_);
    Eigen::Matrix2d R;
    R << c, -s, s, c;
    const Eigen::Vector2d antenna_B(vehicle.antenna_x_m, vehicle.antenna_y_m);
    const Eigen::Vector2d velocity_B(speed_ - yaw_rate_ * antenna_B.y(), yaw_rate_ * antenna_B.x());
    Eigen::Vector2d p = position_ + R * antenna_B + errors_.bias_en + markov_ + jump_en;
    Eigen::Vector2d v = R * velocity_B;
    for (int axis = 0; axis < 2; ++axis) {
      p(axis) += random_.Normal(0.0, errors_.white_sigma_m);
      v(axis) += random_.Normal(0.0, errors_.velocity_sigma_mps);
    }
    GnssFix fix;
    fix.stamp = Now();
    fix.position = plane_.ToGeodetic(LocalPoint{{p.x(), p.y(), 0.0}});
    fix.covariance_enu = Eigen::Vector3d(0.25, 0.25, 1.0).asDiagonal();
    // East and north at the car, not at the start.
    const Eigen::Vector3d v_E = plane_.R_LE().transpose() * Eigen::Vector3d(v.x(), v.y(), 0.0);
    const Eigen::Vector3d v_N = EastNorthUp(fix.position).transpose() * v_E;
    fix.velocity_en_mps = v_N.head<2>();
    fix.velocity_sigma_mps = std::max(0.05, errors_.velocity_sigma_mps);
    fix.fix_type = FixType::k3d;
    return fix;
  }

  /// Where the rear axle really is, and where its x axis really points.
  [[nodiscard]] Eigen::Vector3d TruePlace_E() const {
    return plane_.ToEcefPoint(LocalPoint{{position_.x(), position_.y(), 0.0}}).p_E;
  }
  [[nodiscard]] Eigen::Vector3d TrueDirection_E() const {
    return plane_.R_LE().transpose() * Eigen::Vector3d(std::cos(yaw_), std::sin(yaw_), 0.0);
  }

  /// Errors of an alignment now: east and north of the car's place [m], yaw [rad].
  [[nodiscard]] Eigen::Vector3d ErrorOf(const Alignment& alignment) const {
    const EgoState ego = Ego();
    const Wgs84 place = alignment.ToGeodetic(ego.X_OB.origin().vector(), 0.0);
    const Eigen::Vector3d off = LocalPlane(place).ToLocal(EcefPoint{TruePlace_E()}).p_L;
    const Eigen::Vector3d direction_L = alignment.plane().R_LE() * TrueDirection_E();
    const double yaw = (alignment.X_LO() * ego.X_OB).yaw_rad();
    return {-off.x(), -off.y(), AngleDifference(yaw, std::atan2(direction_L.y(), direction_L.x()))};
  }

  [[nodiscard]] Timestamp Now() const {
    return FromMicros(1'700'000'000'000'000) + FromSeconds(time_s_);
  }
  [[nodiscard]] double time_s() const { return time_s_; }

  Eigen::Vector2d jump_en = Eigen::Vector2d::Zero();  ///< Added to every fix.

 private:
  static void Step(Eigen::Vector2d& p, double& yaw, double speed, double yaw_rate, double dt) {
    const double middle = yaw + 0.5 * yaw_rate * dt;
    p += speed * dt * Eigen::Vector2d(std::cos(middle), std::sin(middle));
    yaw += yaw_rate * dt;
  }

  LocalPlane plane_;
  Eigen::Vector2d position_ = Eigen::Vector2d::Zero();
  double yaw_ = 0.0;
  Eigen::Vector2d odometry_ = Eigen::Vector2d::Zero();
  double odometry_yaw_ = 0.0;
  DriveErrors errors_;
  double learnt_bias_radps_ = 0.0;
  double learnt_factor_ = 1.0;
  Random random_;
  Eigen::Vector2d markov_ = Eigen::Vector2d::Zero();
  double time_s_ = 0.0;
  double speed_ = 0.0;
  double yaw_rate_ = 0.0;
};

}  // namespace v2vouch
