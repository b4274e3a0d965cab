// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "sim/run_log/scene_specs.h"
#include "sim/run_log/truth.h"

namespace v2vouch::evaluation {

/// Error covariance of the best estimate of one vehicle, propagated along its true path.
/// State: position, velocity, acceleration (world frame), then the sender's errors: constant
/// position bias (2), Gauss-Markov position error (2), speed error, heading error.
class InformationFilter {
 public:
  static constexpr int kSize = 12;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  /// Acceleration spread along and across the heading, and how long it lasts.
  struct Manoeuvre {
    double along_mps2 = 0.5;
    double across_mps2 = 0.3;
    double time_s = 1.5;
  };

  InformationFilter(const Manoeuvre& manoeuvre, const SenderSpec& sender);

  void Reset();  ///< Nothing known but that it is a vehicle within 200 m.
  void Predict(double dt_s, double yaw_rad);
  /// Gathers one look's information; Apply() uses all gathered at once.
  void AddSensor(const SensorSpec& sensor, const PlanarMotion& ego, const PlanarMotion& target,
                 double detection_probability);
  void AddBsm(const PlanarMotion& target);
  void Apply();

  /// E |position error|^2 [m^2].
  [[nodiscard]] double position_variance_m2() const { return P_(0, 0) + P_(1, 1); }

 private:
  void Add(const Vector& row, double sigma, double weight);

  Manoeuvre manoeuvre_;
  SenderSpec sender_;
  Matrix P_ = Matrix::Zero();
  Matrix gathered_ = Matrix::Zero();
  bool has_gathered_ = false;
};

}  // namespace v2vouch::evaluation
