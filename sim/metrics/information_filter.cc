// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/information_filter.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace v2vouch::evaluation {
namespace {

// Places in the state.
constexpr int kPosition = 0;
constexpr int kVelocity = 2;
constexpr int kAcceleration = 4;
constexpr int kBias = 6;
constexpr int kMarkov = 8;
constexpr int kSpeedError = 10;
constexpr int kHeadingError = 11;

// What is known of an object before the first look.
constexpr double kPriorPosition_m = 200.0;
constexpr double kPriorVelocity_mps = 15.0;
// A sender's accelerometer and gyro; the scenario format does not state them.
constexpr double kBsmAcceleration_mps2 = 0.2;
constexpr double kLeastRange_m = 2.0;
constexpr double kLeastSigma = 1e-3;  // Of scenarios that switch an error off.

}  // namespace

InformationFilter::InformationFilter(const Manoeuvre& manoeuvre, const SenderSpec& sender)
    : manoeuvre_(manoeuvre), sender_(sender) {
  Reset();
}

void InformationFilter::Reset() {
  const double spread = std::max(manoeuvre_.along_mps2, manoeuvre_.across_mps2);
  Vector sigma;
  sigma << Eigen::Vector2d::Constant(kPriorPosition_m),
      Eigen::Vector2d::Constant(kPriorVelocity_mps), Eigen::Vector2d::Constant(spread),
      Eigen::Vector2d::Constant(std::max(sender_.bias_sigma_m, kLeastSigma)),
      Eigen::Vector2d::Constant(std::max(sender_.markov_sigma_m, kLeastSigma)),
      std::max(sender_.speed_markov_mps, kLeastSigma),
      std::max(sender_.heading_markov_rad, kLeastSigma);
  P_ = sigma.cwiseAbs2().asDiagonal();
  gathered_.setZero();
  has_gathered_ = false;
}

void InformationFilter::Predict(double dt_s, double yaw_rad) {
  const double a = 1.0 / manoeuvre_.time_s;
  const double decay = std::exp(-a * dt_s);
  Matrix F = Matrix::Identity();
  for (int axis = 0; axis < 2; ++axis) {
    F(kPosition + axis, kVelocity + axis) = dt_s;
    F(kPosition + axis, kAcceleration + axis) = (a * dt_s - 1.0 + decay) / (a * a);
    F(kVelocity + axis, kAcceleration + axis) = (1.0 - decay) / a;
    F(kAcceleration + axis, kAcceleration + axis) = decay;
  }
  const double markov = std::exp(-dt_s / sender_.markov_time_s);
  for (int k = kMarkov; k <= kHeadingError; ++k) F(k, k) = markov;

  // Singer's Q for steps much shorter than its time constant: white jerk of density 2 a sigma^2.
  const double T = dt_s;
  Eigen::Matrix3d q;
  q << std::pow(T, 5) / 20.0, std::pow(T, 4) / 8.0, std::pow(T, 3) / 6.0, std::pow(T, 4) / 8.0,
      std::pow(T, 3) / 3.0, T * T / 2.0, std::pow(T, 3) / 6.0, T * T / 2.0, T;
  q *= 2.0 * a;
  const Eigen::Vector2d along(std::cos(yaw_rad), std::sin(yaw_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Matrix2d spread =
      manoeuvre_.along_mps2 * manoeuvre_.along_mps2 * along * along.transpose() +
      manoeuvre_.across_mps2 * manoeuvre_.across_mps2 * across * across.transpose();
  Matrix Q = Matrix::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) Q.block<2, 2>(2 * i, 2 * j) = q(i, j) * spread;
  }
  const auto drive = [&](int k, double sigma) {
    const double s = std::max(sigma, kLeastSigma);
    Q(k, k) = s * s * (1.0 - markov * markov);
  };
  drive(kMarkov, sender_.markov_sigma_m);
  drive(kMarkov + 1, sender_.markov_sigma_m);
  drive(kSpeedError, sender_.speed_markov_mps);
  drive(kHeadingError, sender_.heading_markov_rad);
  P_ = F * P_ * F.transpose() + Q;
}

void InformationFilter::Add(const Vector& row, double sigma, double weight) {
  const double s = std::max(sigma, 1e-6);
  gathered_ += weight / (s * s) * row * row.transpose();
  has_gathered_ = true;
}

void InformationFilter::AddSensor(const SensorSpec& sensor, const PlanarMotion& ego,
                                  const PlanarMotion& target, double detection_probability) {
  const double c = std::cos(ego.yaw_rad);
  const double s = std::sin(ego.yaw_rad);
  const Eigen::Vector2d lever(c * sensor.x_m - s * sensor.y_m, s * sensor.x_m + c * sensor.y_m);
  const Eigen::Vector2d v_sensor =
      ego.speed_mps * ego.direction() + ego.yaw_rate_radps * Eigen::Vector2d(-lever.y(), lever.x());
  const Eigen::Vector2d d = target.position() - ego.position() - lever;
  const double range = std::max(d.norm(), kLeastRange_m);
  const Eigen::Vector2d u = d / range;
  const Eigen::Vector2d w(-u.y(), u.x());

  Vector row = Vector::Zero();
  if (sensor.kind == SensorKind::kObjects) {
    for (int axis = 0; axis < 2; ++axis) {
      row.setZero();
      row(kPosition + axis) = 1.0;
      Add(row, sensor.position_sigma_m, detection_probability);
    }
    return;
  }
  const bool is_radar = sensor.kind == SensorKind::kRadar;
  row.segment<2>(kPosition) = w / range;
  const double off_axis = std::atan2(u.y(), u.x()) - ego.yaw_rad - sensor.yaw_rad;
  // An edge's pixel noise spans less angle away from a camera's axis.
  const double foreshortening = is_radar ? 1.0 : std::cos(off_axis) * std::cos(off_axis);
  Add(row, sensor.azimuth_sigma_rad * std::max(foreshortening, 0.1), detection_probability);

  row.setZero();
  row.segment<2>(kPosition) = u;
  if (!is_radar) {
    // Depression of the foot point: d(delta)/dr = -h / (r^2 + h^2).
    const double per_rad = (range * range + sensor.z_m * sensor.z_m) / std::max(sensor.z_m, 0.1);
    return Add(row, sensor.depression_sigma_rad * per_rad, detection_probability);
  }
  Add(row, sensor.range_sigma_m, detection_probability);
  const Eigen::Vector2d v = target.speed_mps * target.direction() - v_sensor;
  row.setZero();
  row.segment<2>(kPosition) = v.dot(w) / range * w;
  row.segment<2>(kVelocity) = u;
  Add(row, sensor.range_rate_sigma_mps, detection_probability);
}

void InformationFilter::AddBsm(const PlanarMotion& target) {
  for (int axis = 0; axis < 2; ++axis) {
    Vector row = Vector::Zero();
    row(kPosition + axis) = row(kBias + axis) = row(kMarkov + axis) = 1.0;
    Add(row, std::max(sender_.white_sigma_m, kLeastSigma), 1.0);
  }
  const Eigen::Vector2d along = target.direction();
  const Eigen::Vector2d across(-along.y(), along.x());
  Vector row = Vector::Zero();
  row.segment<2>(kVelocity) = along;
  row(kSpeedError) = 1.0;
  Add(row, std::max(sender_.speed_white_mps, kLeastSigma), 1.0);

  // Heading times speed is the velocity across; at rest it says nothing of the motion.
  const double speed = std::max(std::abs(target.speed_mps), 0.1);
  row.setZero();
  row.segment<2>(kVelocity) = across;
  row(kHeadingError) = speed;
  Add(row, speed * std::max(sender_.heading_white_rad, kLeastSigma), 1.0);

  for (const Eigen::Vector2d& direction : {along, across}) {
    row.setZero();
    row.segment<2>(kAcceleration) = direction;
    Add(row, kBsmAcceleration_mps2, 1.0);
  }
}

void InformationFilter::Apply() {
  if (!has_gathered_) return;
  // (P^-1 + J)^-1 = P (I + J P)^-1, which never inverts the poorly conditioned P.
  const Matrix inner = Matrix::Identity() + gathered_ * P_;
  P_ = P_ * inner.inverse();
  P_ = 0.5 * (P_ + P_.transpose()).eval();
  gathered_.setZero();
  has_gathered_ = false;
}

}  // namespace v2vouch::evaluation
