// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/extended_filter.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace v2vouch::evaluation {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr int kPosition = 0, kVelocity = 2, kAcceleration = 4;
constexpr int kLength = 6, kWidth = 7, kAlongError = 8, kAcrossError = 9;

constexpr double kPriorPosition_m = 200.0, kPriorVelocity_mps = 15.0;
constexpr double kLeastRange_m = 2.0;
constexpr double kFace_m = 0.3, kEdge_m = 0.5, kDoppler_mps = 0.13;
constexpr double kAlong_m = 0.15, kAlong_s = 3.0;
constexpr double kAcross = 0.35, kAcross_s = 5.0;  // In half silhouettes.
constexpr double kBoxEdgeShare = 0.02, kBoxCorrelation = 1.7;

}  // namespace

SizePrior SizePriorOf(int object_class) {
  switch (object_class) {
    case 2:  // Van.
      return {0.6, 0.15};
    case 3:  // Truck.
    case 4:  // Bus.
      return {2.2, 0.3};
    case 5:  // Motorcycle.
      return {0.2, 0.1};
    default:
      return {};
  }
}

ExtendedFilter::ExtendedFilter(const InformationFilter::Manoeuvre& manoeuvre,
                               const SizePrior& prior)
    : manoeuvre_(manoeuvre), prior_(prior) {
  Reset();
}

void ExtendedFilter::Reset() {
  const double spread = std::max(manoeuvre_.along_mps2, manoeuvre_.across_mps2);
  Vector sigma;
  sigma << kPriorPosition_m, kPriorPosition_m, kPriorVelocity_mps, kPriorVelocity_mps, spread,
      spread, prior_.length_sigma_m, prior_.width_sigma_m, kAlong_m, kAcross;
  P_ = sigma.cwiseAbs2().asDiagonal();
  gathered_.setZero();
  has_gathered_ = false;
}

void ExtendedFilter::Predict(double dt_s, double yaw_rad) {
  const double a = 1.0 / manoeuvre_.time_s;
  const double decay = std::exp(-a * dt_s);
  Matrix F = Matrix::Identity();
  for (int axis = 0; axis < 2; ++axis) {
    F(kPosition + axis, kVelocity + axis) = dt_s;
    F(kPosition + axis, kAcceleration + axis) = (a * dt_s - 1.0 + decay) / (a * a);
    F(kVelocity + axis, kAcceleration + axis) = (1.0 - decay) / a;
    F(kAcceleration + axis, kAcceleration + axis) = decay;
  }
  const double along_decay = std::exp(-dt_s / kAlong_s);
  const double across_decay = std::exp(-dt_s / kAcross_s);
  F(kAlongError, kAlongError) = along_decay;
  F(kAcrossError, kAcrossError) = across_decay;
  // Singer's Q as in InformationFilter: white jerk of density 2 a sigma^2.
  const double T = dt_s;
  Eigen::Matrix3d q;
  q << std::pow(T, 5) / 20.0, std::pow(T, 4) / 8.0, std::pow(T, 3) / 6.0, std::pow(T, 4) / 8.0,
      std::pow(T, 3) / 3.0, T * T / 2.0, std::pow(T, 3) / 6.0, T * T / 2.0, T;
  q *= 2.0 * a;
  const Vec2 along(std::cos(yaw_rad), std::sin(yaw_rad));
  const Vec2 across(-along.y(), along.x());
  const Eigen::Matrix2d spread =
      manoeuvre_.along_mps2 * manoeuvre_.along_mps2 * along * along.transpose() +
      manoeuvre_.across_mps2 * manoeuvre_.across_mps2 * across * across.transpose();
  Matrix Q = Matrix::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) Q.block<2, 2>(2 * i, 2 * j) = q(i, j) * spread;
  }
  Q(kAlongError, kAlongError) = kAlong_m * kAlong_m * (1.0 - along_decay * along_decay);
  Q(kAcrossError, kAcrossError) = kAcross * kAcross * (1.0 - across_decay * across_decay);
  P_ = F * P_ * F.transpose() + Q;
}

void ExtendedFilter::Add(const Vector& row, double sigma, double weight) {
  const double s = std::max(sigma, 1e-6);
  gathered_ += weight / (s * s) * row * row.transpose();
  has_gathered_ = true;
}

void ExtendedFilter::AddSensor(const SensorSpec& sensor, const PlanarMotion& ego,
                               const PlanarMotion& target, double length_m, double width_m,
                               double detection_probability) {
  const double c = std::cos(ego.yaw_rad), s = std::sin(ego.yaw_rad);
  const Vec2 lever(c * sensor.x_m - s * sensor.y_m, s * sensor.x_m + c * sensor.y_m);
  const Vec2 d = target.position() - ego.position() - lever;
  const double range = std::max(d.norm(), kLeastRange_m);
  const Vec2 u = d / range, w(-u.y(), u.x());
  const double cosine = std::max(0.02, std::abs(u.dot(target.direction())));
  const double sine = std::max(0.02, std::abs(w.dot(target.direction())));
  const bool meets_end = length_m / cosine < width_m / sine;
  const double half = 0.5 * (sine * length_m + cosine * width_m);

  // Along the sight: the near outline.
  Vector row = Vector::Zero();
  row.segment<2>(kPosition) = u;
  (meets_end ? row(kLength) : row(kWidth)) = -0.5 / (meets_end ? cosine : sine);
  const bool is_radar = sensor.kind == SensorKind::kRadar;
  const bool is_camera = sensor.kind == SensorKind::kCamera;
  if (is_radar) {
    row(kAlongError) = 1.0;
    Add(row, std::hypot(kFace_m, sensor.range_sigma_m), detection_probability);
  } else if (!is_camera) {  // A box on the ground, by its nearest face.
    Add(row, sensor.position_sigma_m, detection_probability);
  } else {
    const double per_rad = (range * range + sensor.z_m * sensor.z_m) / std::max(sensor.z_m, 0.1);
    Add(row, sensor.depression_sigma_rad * per_rad, detection_probability);
  }
  // Across: both edges of the silhouette.
  const double box_edge =
      kBoxCorrelation *
      std::hypot(std::sqrt(2.0) * sensor.azimuth_sigma_rad * range, 2.0 * kBoxEdgeShare * half);
  const double radar_edge = std::hypot(kEdge_m, range * sensor.azimuth_sigma_rad);
  const double ground_edge = is_radar ? radar_edge : sensor.position_sigma_m;
  const double edge = is_camera ? box_edge : ground_edge;
  for (const double side : {1.0, -1.0}) {
    row.setZero();
    row.segment<2>(kPosition) = w;
    row(kLength) = side * 0.5 * sine;
    row(kWidth) = side * 0.5 * cosine;
    if (is_radar) row(kAcrossError) = half;
    Add(row, edge, detection_probability);
  }
  if (!is_radar) return;
  const Vec2 v_sensor =
      ego.speed_mps * ego.direction() + ego.yaw_rate_radps * Vec2(-lever.y(), lever.x());
  const Vec2 v = target.speed_mps * target.direction() - v_sensor;
  row.setZero();
  row.segment<2>(kPosition) = v.dot(w) / range * w;
  row.segment<2>(kVelocity) = u;
  Add(row, std::hypot(kDoppler_mps, sensor.range_rate_sigma_mps), detection_probability);
}

void ExtendedFilter::Apply() {
  if (!has_gathered_) return;
  const Matrix inner = Matrix::Identity() + gathered_ * P_;
  P_ = P_ * inner.inverse();
  P_ = 0.5 * (P_ + P_.transpose()).eval();
  gathered_.setZero();
  has_gathered_ = false;
}

}  // namespace v2vouch::evaluation
