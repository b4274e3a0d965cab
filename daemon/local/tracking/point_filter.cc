// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/point_filter.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/dual.h"
#include "daemon/common/models/extent.h"
#include "daemon/common/models/kalman.h"

namespace v2vouch {
namespace {

// Across the line of sight one frame says nothing about the velocity: road traffic, 1 sigma.
constexpr double kCrossSpeedSigma_mps = 10.0;
constexpr double kCameraSpeedSigma_mps = 8.0;
constexpr double kPairedSpeedSigma_mps = 2.0;
// White acceleration of a point [m^2/s^3]: 2 m/s^2 that last for about a second, and what is left
// of it in something that stands, walks or creeps. Half way between at a root mean square of the
// velocity of so much: with the noise of traffic, 3 m/s across the line of sight never stand out.
constexpr double kPointAccelPsd = 4.0;
constexpr double kSlowAccelPsd = 0.4;
constexpr double kSlow_mps = 6.0;
// Nothing is predicted farther; beyond it, the position grows uncertain at the speed of traffic.
constexpr double kLongest_s = 10.0;
constexpr double kAnySpeed_mps = 20.0;
// One reflection lies anywhere on a vehicle whose direction is unknown: this far from the mean of
// all, radially and across (a car's side scatters by 1.3 m, its tail by 0.5 m). Part of it stays
// however many reflections there are.
constexpr double kReflectionRadialSigma_m = 0.5;
constexpr double kReflectionAcrossSigma_m = 0.9;
constexpr double kPointRadialSigma_m = 0.15;
constexpr double kPointAcrossSigma_m = 0.2;
// An object's place may be any point of the vehicle, and another one soon.
constexpr double kObjectRadialSigma_m = 1.3;
constexpr double kObjectAcrossSigma_m = 0.8;
// A velocity that points somewhere.
constexpr double kDirectedSpeed_mps = 1.0;
// One that is none: this sure, in the direction it is known worst.
constexpr double kStandingSigma_mps = 0.7;

using Vector = Linearized::Vector;
using PointJacobian = Eigen::Matrix<double, Eigen::Dynamic, 4, 0, Linearized::kMaxRows, 4>;

struct PointModel {
  Vector y;
  PointJacobian H;
  Linearized::Covariance R;
};

// Noise of a cluster as a measurement of "the" reflecting point.
Eigen::Matrix3d PointNoise(const RadarMeasurement& z, const RadarConfig& radar) {
  Eigen::Matrix3d R = z.covariance;
  const double n = z.is_object ? 16.0 : std::max(z.returns, 1);
  const auto square = [](double a) { return a * a; };
  // The sample's own scatter tells little for a few reflections: the larger of the two counts.
  R(0, 0) = std::max(R(0, 0), (std::min(R(0, 0) * n, square(radar.range_sigma_m)) +
                               square(kReflectionRadialSigma_m)) /
                                  n) +
            square(kPointRadialSigma_m);
  R(1, 1) = std::max(R(1, 1), (std::min(R(1, 1) * n, square(radar.azimuth_sigma_rad)) +
                               square(kReflectionAcrossSigma_m / z.range_m)) /
                                  n) +
            square(kPointAcrossSigma_m / z.range_m);
  if (z.is_object) {
    R(0, 0) += square(kObjectRadialSigma_m);
    R(1, 1) += square(kObjectAcrossSigma_m / z.range_m);
  }
  const double unseen = kUnseenLooks * square(std::clamp(1.0 - z.visible_share, 0.0, 1.0));
  R(0, 0) += unseen * square(kReflectionRadialSigma_m);
  R(1, 1) += unseen * square(kReflectionAcrossSigma_m / z.range_m);
  return R;
}

std::optional<PointModel> LinearizePoint(const Eigen::Vector4d& x, const RadarLook& look,
                                         const RadarMeasurement& z, bool is_exact) {
  using D = Dual<4>;
  const Pose<Odometry, Radar> X_OR =
      look.ego.X_OB * Pose<Body, Radar>(look.radar.x_m, look.radar.y_m, look.radar.yaw_rad);
  const Eigen::Matrix2d R_OB = look.ego.X_OB.rotation();
  const Eigen::Vector2d v_R_O = R_OB * AntennaVelocity_B(look.ego, look.radar);
  const D qx = D::Variable(x[0] - X_OR.x_m(), 0);
  const D qy = D::Variable(x[1] - X_OR.y_m(), 1);
  const D vx = D::Variable(x[2] - v_R_O.x(), 2);
  const D vy = D::Variable(x[3] - v_R_O.y(), 3);
  const D range = sqrt(qx * qx + qy * qy);
  if (!(range.value > 0.1)) return std::nullopt;
  const D range_rate = (qx * vx + qy * vy) / range;
  const D azimuth = atan2(qy, qx);
  PointModel out;
  out.y.resize(3);
  out.y << z.range_m - range.value, WrapAngle(z.azimuth_rad + X_OR.yaw_rad() - azimuth.value),
      z.range_rate_mps - range_rate.value;
  out.H.resize(3, 4);
  out.H << range.gradient, azimuth.gradient, range_rate.gradient;
  out.R = is_exact ? z.covariance : PointNoise(z, look.radar);
  const Eigen::Vector2d line_B =
      R_OB.transpose() * Eigen::Vector2d(qx.value / range.value, qy.value / range.value);
  out.R(2, 2) += EgoMotionVariances(look.ego, look.radar, line_B).sum();
  return out;
}

std::optional<PointModel> LinearizePoint(const Eigen::Vector4d& x, const CameraLook& look,
                                         const CameraMeasurement& z, bool is_exact) {
  using D = Dual<4>;
  if (z.left_is_cut || z.right_is_cut) return std::nullopt;
  const Pose<Odometry, Camera> X_OC =
      look.ego.X_OB * Pose<Body, Camera>(look.camera.x_m, look.camera.y_m, look.camera.yaw_rad);
  const double c = std::cos(X_OC.yaw_rad());
  const double s = std::sin(X_OC.yaw_rad());
  const D px = D::Variable(x[0] - X_OC.x_m(), 0);
  const D py = D::Variable(x[1] - X_OC.y_m(), 1);
  const D qx = c * px + s * py;
  const D qy = c * py - s * px;
  if (!(qx.value > 0.3)) return std::nullopt;
  const double middle = 0.5 * (z.azimuth_left_rad + z.azimuth_right_rad);
  const D bearing = atan2(qy, qx);
  const double range = std::hypot(qx.value, qy.value);
  const int rows = z.bottom_is_cut ? 1 : 2;
  PointModel out;
  out.y.resize(rows);
  out.H.resize(rows, 4);
  out.R.setZero(rows, rows);
  out.y[0] = WrapAngle(middle - bearing.value);
  out.H.row(0) = bearing.gradient;
  const double across = is_exact ? 0.0 : kPointAcrossSigma_m / range;
  // A box narrower than what it is called shows a part of it: the middle of the rest lies anywhere
  // from one end of what is missing to the other.
  const double width_rad = z.azimuth_left_rad - z.azimuth_right_rad;
  const double whole_rad = ClassExtent(z.object_class).width_m / std::max(range, 1.0);
  const double missing = is_exact ? 0.0 : 0.5 * std::max(0.0, whole_rad - width_rad);
  out.R(0, 0) =
      0.5 * z.azimuth_sigma_rad * z.azimuth_sigma_rad + across * across + missing * missing;
  if (rows == 2) {
    const D depression = atan2(D(look.camera.z_m * std::cos(middle)), qx);
    const double radial = is_exact ? 0.0 : depression.value * 2.0 * kPointRadialSigma_m / qx.value;
    out.y[1] = z.depression_rad - depression.value;
    out.H.row(1) = depression.gradient;
    out.R(1, 1) = z.depression_sigma_rad * z.depression_sigma_rad + radial * radial;
  }
  return out;
}

template <class Model>
std::optional<Likelihood> EvaluateModel(const std::optional<Model>& model,
                                        const Eigen::Matrix4d& covariance) {
  return model ? EvaluateInnovation<4>(model->y, model->H, model->R, covariance) : std::nullopt;
}

}  // namespace

Fix ReflectionFixOf(const RadarLook& look, const RadarMeasurement& z) {
  RadarMeasurement blurred = z;
  blurred.covariance = PointNoise(z, look.radar);
  return FixOf(look, blurred);
}

PointFilter PointFilter::FromRadar(const RadarLook& look, const RadarMeasurement& z,
                                   bool is_exact) {
  PointFilter filter;
  const Fix fix = FixOf(look, z);
  const Eigen::Vector2d line = (fix.p_O - look.origin_O()).normalized();
  const Eigen::Vector2d across(-line.y(), line.x());
  const double radial_sigma = std::sqrt(z.covariance(2, 2)) + look.ego.speed_sigma_mps + 0.1;
  filter.mean_ << fix.p_O, z.ground_range_rate_mps * line;
  filter.covariance_.setZero();
  filter.covariance_.topLeftCorner<2, 2>() =
      is_exact ? fix.covariance : ReflectionFixOf(look, z).covariance;
  filter.covariance_.bottomRightCorner<2, 2>() =
      radial_sigma * radial_sigma * line * line.transpose() +
      kCrossSpeedSigma_mps * kCrossSpeedSigma_mps * across * across.transpose();
  return filter;
}

PointFilter PointFilter::AtRest(const Fix& fix, const Eigen::Matrix2d& velocity_covariance) {
  PointFilter filter;
  filter.mean_ << fix.p_O, 0.0, 0.0;
  filter.covariance_.setZero();
  filter.covariance_.topLeftCorner<2, 2>() = fix.covariance;
  filter.covariance_.bottomRightCorner<2, 2>() = velocity_covariance;
  return filter;
}

PointFilter PointFilter::FromCamera(const Fix& fix) {
  return AtRest(fix, kCameraSpeedSigma_mps * kCameraSpeedSigma_mps * Eigen::Matrix2d::Identity());
}

PointFilter PointFilter::FromStanding(const Fix& fix, const Eigen::Vector2d& seen_from_O) {
  const Eigen::Vector2d line = (fix.p_O - seen_from_O).normalized();
  const Eigen::Vector2d across(-line.y(), line.x());
  return AtRest(fix,
                kPairedSpeedSigma_mps * kPairedSpeedSigma_mps * line * line.transpose() +
                    kCameraSpeedSigma_mps * kCameraSpeedSigma_mps * across * across.transpose());
}

void PointFilter::Predict(double predicted_s) {
  const double dt_s = std::min(predicted_s, kLongest_s);
  const double speed2 = mean_.tail<2>().squaredNorm() + covariance_(2, 2) + covariance_(3, 3);
  const double share = speed2 / (speed2 + kSlow_mps * kSlow_mps);
  const double q = kSlowAccelPsd + (kPointAccelPsd - kSlowAccelPsd) * share;
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F(0, 2) = F(1, 3) = dt_s;
  mean_ = (F * mean_).eval();
  Eigen::Matrix4d P = F * covariance_ * F.transpose();
  for (int i = 0; i < 2; ++i) {
    P(i, i) += q * dt_s * dt_s * dt_s / 3.0;
    P(i, i + 2) += q * dt_s * dt_s / 2.0;
    P(i + 2, i) += q * dt_s * dt_s / 2.0;
    P(i + 2, i + 2) += q * dt_s;
    if (predicted_s > dt_s) P(i, i) += std::pow(kAnySpeed_mps * (predicted_s - dt_s), 2);
  }
  covariance_ = 0.5 * (P + P.transpose());
}

std::optional<Likelihood> PointFilter::Evaluate(const RadarLook& look, const RadarMeasurement& z,
                                                bool is_exact) const {
  return EvaluateModel(LinearizePoint(mean_, look, z, is_exact), covariance_);
}

std::optional<Likelihood> PointFilter::Evaluate(const CameraLook& look, const CameraMeasurement& z,
                                                bool is_exact) const {
  return EvaluateModel(LinearizePoint(mean_, look, z, is_exact), covariance_);
}

bool PointFilter::Update(const RadarLook& look, const RadarMeasurement& z, bool is_exact) {
  const auto model = LinearizePoint(mean_, look, z, is_exact);
  return model && JosephUpdate<4>(model->y, model->H, model->R, mean_, covariance_);
}

bool PointFilter::Update(const CameraLook& look, const CameraMeasurement& z, bool is_exact) {
  const auto model = LinearizePoint(mean_, look, z, is_exact);
  return model && JosephUpdate<4>(model->y, model->H, model->R, mean_, covariance_);
}

PointFilter PointFilter::Doubted(double sigma_mps) const {
  PointFilter doubted = *this;
  doubted.covariance_.bottomRightCorner<2, 2>() +=
      sigma_mps * sigma_mps * Eigen::Matrix2d::Identity();
  return doubted;
}

bool PointFilter::HasDirection(double max_sigma_rad, double most_share) const {
  const Eigen::Vector2d v = mean_.tail<2>();
  const double speed = v.norm();
  if (speed < kDirectedSpeed_mps) return false;
  const Eigen::Vector2d across(-v.y() / speed, v.x() / speed);
  const Eigen::Vector2d along = v / speed;
  const Eigen::Matrix2d P = covariance_.bottomRightCorner<2, 2>();
  const double across_sigma = std::sqrt(across.dot(P * across));
  const double along_sigma = std::sqrt(along.dot(P * along));
  return across_sigma < max_sigma_rad * speed && along_sigma < most_share * speed;
}

bool PointFilter::IsStanding() const {
  if (velocity().norm() > kDirectedSpeed_mps) return false;
  const Eigen::Matrix2d P = covariance_.bottomRightCorner<2, 2>();
  const double mean = 0.5 * (P(0, 0) + P(1, 1));
  const double half = 0.5 * (P(0, 0) - P(1, 1));
  const double largest = mean + std::sqrt(half * half + P(0, 1) * P(0, 1));
  return largest < kStandingSigma_mps * kStandingSigma_mps;
}

}  // namespace v2vouch
