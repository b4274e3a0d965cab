// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/alignment/alignment_filter.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

constexpr double kStandstill_mps = 0.1;  // Slower counts as at rest.
// Correlation length of the odometry's random drift: wheel slip, road crown, tyre.
constexpr double kDriftLength_m = 10.0;
// Priors and random walks of the odometry's systematic errors: a production yaw rate sensor has up
// to 0.1 deg/s of offset, a wheel speed signal up to 1 % of scale (0.8 % measured on a real drive).
constexpr double kYawDriftSigma_radps = 0.002;
constexpr double kLearntSigma_radps = 5e-4;  // Of a gyro offset learnt in one second at rest.
constexpr double kYawDriftWalk = 2e-5;       // [rad/s/sqrt(s)]
constexpr double kScaleSigma = 0.01;
constexpr double kScaleWalk = 1e-4;  // [1/sqrt(s)]
// Correlation times of a receiver's errors: position 4.5 to 5.5 s was measured on a real drive;
// velocities pass a filter of about half a second.
constexpr double kPositionCorrelation_s = 5.0;
constexpr double kVelocityCorrelation_s = 0.5;
// Side slip of the rear axle: constant part, and per m/s^2 of lateral acceleration.
constexpr double kSlip_rad = 0.005;
constexpr double kSlipPerLateralAccel = 0.005;
// A course or heading off by more than this plus four sigma contradicts the estimate.
constexpr double kYawJump_rad = 0.2;

Eigen::Matrix2d Rotation(double yaw_rad) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}

// d/dyaw of Rotation(yaw) * v.
Eigen::Vector2d Turned(const Eigen::Vector2d& rotated) { return {-rotated.y(), rotated.x()}; }

// A sample of coloured noise every `interval_s` is worth this many times its variance.
double ColourFactor(double correlation_s, double interval_s) {
  return std::max(1.0, 2.0 * correlation_s / std::max(interval_s, 1e-3));
}

}  // namespace

AlignmentFilter::AlignmentFilter(const FixInPlane& fix, double yaw_LO_rad, double yaw_sigma_rad,
                                 const Eigen::Vector2d& antenna_B, const EgoState& ego)
    : X_OB_(ego.X_OB),
      gyro_offset_radps_(ego.gyro_offset_radps),
      speed_factor_(ego.speed_factor),
      stamp_(ego.stamp),
      last_update_(ego.stamp) {
  const Eigen::Vector2d arm_L = Rotation(yaw_LO_rad) * (ego.X_OB.rotation() * antenna_B);
  const Eigen::Vector2d arm_slope = Turned(arm_L);
  const double yaw_variance = yaw_sigma_rad * yaw_sigma_rad;
  mean_.head<2>() = fix.p_L - arm_L;
  mean_(kYaw) = WrapAngle(yaw_LO_rad);
  covariance_.setZero();
  covariance_.topLeftCorner<2, 2>() =
      fix.covariance + yaw_variance * arm_slope * arm_slope.transpose();
  covariance_.block<2, 1>(0, kYaw) = -yaw_variance * arm_slope;
  covariance_.block<1, 2>(kYaw, 0) = covariance_.block<2, 1>(0, kYaw).transpose();
  covariance_(kYaw, kYaw) = yaw_variance;
  covariance_(kYawDrift, kYawDrift) = kYawDriftSigma_radps * kYawDriftSigma_radps;
  covariance_(kScale, kScale) = kScaleSigma * kScaleSigma;
}

Eigen::Vector2d AlignmentFilter::AntennaVelocity_B(const Eigen::Vector2d& antenna_B,
                                                   const EgoState& ego) {
  return {ego.speed_mps - ego.yaw_rate_radps * antenna_B.y(), ego.yaw_rate_radps * antenna_B.x()};
}

double AlignmentFilter::ColourOfPositions(double interval_s) {
  return ColourFactor(kPositionCorrelation_s, interval_s);
}

double AlignmentFilter::ColourOfVelocities(double interval_s) {
  return ColourFactor(kVelocityCorrelation_s, interval_s);
}

bool AlignmentFilter::IsStanding(const EgoState& ego) {
  return std::abs(ego.speed_mps) < kStandstill_mps;
}

void AlignmentFilter::Predict(const EgoState& ego, const AlignmentNoise& noise) {
  const double dt = std::max(0.0, ToSeconds(ego.stamp - stamp_));
  const Eigen::Vector2d moved_O = ego.X_OB.origin().vector() - X_OB_.origin().vector();
  const double turned_O = AngleDifference(ego.X_OB.yaw_rad(), X_OB_.yaw_rad());
  const double distance = moved_O.norm();
  const bool is_standing = IsStanding(ego);
  // What odometry has learnt to correct since is no longer left for this filter. A car that drives
  // off has learnt the gyro's offset at standstill, better than fixes can tell it: no drift is
  // left.
  if (!is_standing && ego.gyro_offset_radps != gyro_offset_radps_) {
    mean_(kYawDrift) += ego.gyro_offset_radps - gyro_offset_radps_;
    gyro_offset_radps_ = ego.gyro_offset_radps;
    const Vector gain = covariance_.col(kYawDrift) / (covariance_(kYawDrift, kYawDrift) +
                                                      kLearntSigma_radps * kLearntSigma_radps);
    mean_ -= gain * mean_(kYawDrift);
    covariance_ -= (gain * covariance_.row(kYawDrift)).eval();
  }
  if (ego.speed_factor != speed_factor_) {
    mean_(kScale) = (1.0 + mean_(kScale)) * speed_factor_ / ego.speed_factor - 1.0;
  }
  speed_factor_ = ego.speed_factor;

  // Yaw at the middle of the interval, so that a drift during it is counted half.
  const double drift = is_standing ? 0.0 : mean_(kYawDrift) * dt;
  const Eigen::Vector2d moved_L = Rotation(mean_(kYaw) + 0.5 * drift) * moved_O;
  Matrix F = Matrix::Identity();
  F.block<2, 1>(0, kYaw) = (1.0 + mean_(kScale)) * Turned(moved_L);
  F.block<2, 1>(0, kScale) = moved_L;
  if (!is_standing) {
    F.block<2, 1>(0, kYawDrift) = 0.5 * dt * (1.0 + mean_(kScale)) * Turned(moved_L);
    F(kYaw, kYawDrift) = dt;
  }
  mean_.head<2>() += (1.0 + mean_(kScale)) * moved_L;
  // A stationary car does not turn: a turn of O is then drift, and L is turned back by it.
  mean_(kYaw) = WrapAngle(mean_(kYaw) + (is_standing ? -turned_O : drift));
  covariance_ = F * covariance_ * F.transpose();
  if (!is_standing) {
    const double walk = noise.drift_per_m * noise.drift_per_m * kDriftLength_m * distance;
    covariance_(kEast, kEast) += walk;
    covariance_(kNorth, kNorth) += walk;
    covariance_(kYaw, kYaw) += noise.yaw_drift_per_s * noise.yaw_drift_per_s * dt;
    covariance_(kYawDrift, kYawDrift) += kYawDriftWalk * kYawDriftWalk * dt;
    covariance_(kScale, kScale) += kScaleWalk * kScaleWalk * dt;
  }
  X_OB_ = ego.X_OB;
  stamp_ = std::max(stamp_, ego.stamp);
}

std::optional<double> AlignmentFilter::YawFromCourse(const FixInPlane& fix,
                                                     const Eigen::Vector2d& antenna_B,
                                                     const EgoState& ego, double min_speed_mps) {
  // Both the receiver and the wheels must say that the car moves.
  if (!fix.v_L || fix.v_L->norm() < min_speed_mps || std::abs(ego.speed_mps) < min_speed_mps) {
    return std::nullopt;
  }
  // In reverse the antenna's velocity points backwards in B, and so this needs no case for it.
  const Eigen::Vector2d v_B = AntennaVelocity_B(antenna_B, ego);
  const double course_L = std::atan2(fix.v_L->y(), fix.v_L->x());
  return WrapAngle(course_L - ego.X_OB.yaw_rad() - std::atan2(v_B.y(), v_B.x()));
}

double AlignmentFilter::CourseSigma(const FixInPlane& fix, const EgoState& ego) {
  const double speed = std::max(1.0, std::abs(ego.speed_mps));
  const double slip =
      kSlip_rad + kSlipPerLateralAccel * std::abs(ego.speed_mps * ego.yaw_rate_radps);
  return std::hypot(fix.velocity_sigma_mps / speed, slip);
}

std::string_view AlignmentFilter::Contradiction(const FixInPlane& fix,
                                                const Eigen::Vector2d& antenna_B,
                                                const EgoState& ego, const AlignmentNoise& noise,
                                                double jump_m) const {
  const Eigen::Vector2d arm_L = Rotation(mean_(kYaw)) * (ego.X_OB.rotation() * antenna_B);
  const Eigen::Vector2d innovation = fix.p_L - (mean_.head<2>() + arm_L);
  Eigen::Matrix<double, 2, 3> H = Eigen::Matrix<double, 2, 3>::Zero();
  H.leftCols<2>().setIdentity();
  H.col(2) = Turned(arm_L);
  const Eigen::Matrix2d S = H * PoseCovariance() * H.transpose() + fix.covariance;
  const double distance = innovation.norm();
  if (distance > 0.0) {
    const Eigen::Vector2d direction = innovation / distance;
    const double sigma = std::sqrt(std::max(0.0, direction.dot(S * direction)));
    if (distance > jump_m + 4.0 * sigma) return "latitude_rad and longitude_rad";
  }
  const auto is_off = [this](double yaw_LO, double sigma) {
    const double total = std::sqrt(covariance_(kYaw, kYaw) + sigma * sigma);
    return std::abs(AngleDifference(yaw_LO, mean_(kYaw))) > kYawJump_rad + 4.0 * total;
  };
  const auto course = YawFromCourse(fix, antenna_B, ego, noise.min_course_speed_mps);
  if (course && is_off(*course, CourseSigma(fix, ego))) {
    return "velocity_east_mps and velocity_north_mps";
  }
  const bool is_heading_off =
      fix.yaw_L_rad && is_off(*fix.yaw_L_rad - ego.X_OB.yaw_rad(), fix.yaw_sigma_rad);
  return is_heading_off ? "heading_rad" : "";
}

void AlignmentFilter::Update(const FixInPlane& fix, const Eigen::Vector2d& antenna_B,
                             const EgoState& ego, const AlignmentNoise& noise) {
  const double interval = std::clamp(ToSeconds(stamp_ - last_update_), 0.02, 10.0);
  last_update_ = stamp_;
  const bool is_standing = IsStanding(ego);

  const Eigen::Vector2d arm_L = Rotation(mean_(kYaw)) * (ego.X_OB.rotation() * antenna_B);
  Eigen::Matrix<double, 2, kSize> H = Eigen::Matrix<double, 2, kSize>::Zero();
  H.leftCols<2>().setIdentity();
  H.col(kYaw) = Turned(arm_L);
  const Eigen::Matrix2d R = fix.covariance * ColourFactor(kPositionCorrelation_s, interval);
  const Eigen::Matrix2d S = H * covariance_ * H.transpose() + R;
  Eigen::Matrix<double, kSize, 2> K = covariance_ * H.transpose() * S.inverse();
  // Wandering fixes of a stationary car carry no direction and no odometry error: those states
  // are considered, not estimated (Schmidt), which the Joseph form below accounts for exactly.
  if (is_standing) K.bottomRows<3>().setZero();
  const Matrix I_KH = Matrix::Identity() - K * H;
  mean_ += K * (fix.p_L - (mean_.head<2>() + arm_L));
  covariance_ = I_KH * covariance_ * I_KH.transpose() + K * R * K.transpose();
  mean_(kYaw) = WrapAngle(mean_(kYaw));

  if (const auto yaw = YawFromCourse(fix, antenna_B, ego, noise.min_course_speed_mps)) {
    const double sigma = CourseSigma(fix, ego);
    UpdateYaw(*yaw, sigma * sigma * ColourFactor(kVelocityCorrelation_s, interval));
  }
  // At standstill a receiver's heading is often a held or a wandering one: it may only help where
  // ours is the worse.
  if (fix.yaw_L_rad &&
      (!is_standing || covariance_(kYaw, kYaw) > fix.yaw_sigma_rad * fix.yaw_sigma_rad)) {
    UpdateYaw(
        *fix.yaw_L_rad - ego.X_OB.yaw_rad(),
        fix.yaw_sigma_rad * fix.yaw_sigma_rad * ColourFactor(kPositionCorrelation_s, interval));
  }
}

void AlignmentFilter::UpdateYaw(double yaw_LO_rad, double variance) {
  const Vector column = covariance_.col(kYaw);
  const double s = column(kYaw) + variance;
  const Vector K = column / s;
  mean_ += K * AngleDifference(yaw_LO_rad, mean_(kYaw));
  mean_(kYaw) = WrapAngle(mean_(kYaw));
  Matrix I_KH = Matrix::Identity();
  I_KH.col(kYaw) -= K;
  covariance_ = I_KH * covariance_ * I_KH.transpose() + variance * K * K.transpose();
}

void AlignmentFilter::Rebase(const Eigen::Vector2d& p_L, double turn_rad) {
  Matrix turn = Matrix::Identity();
  turn.topLeftCorner<2, 2>() = Rotation(turn_rad);
  mean_.head<2>() = p_L;
  mean_(kYaw) = WrapAngle(mean_(kYaw) + turn_rad);
  covariance_ = turn * covariance_ * turn.transpose();
}

void AlignmentFilter::InheritOdometryErrors(const AlignmentFilter& other) {
  mean_.tail<2>() = other.mean_.tail<2>();
  covariance_.rightCols<2>().setZero();
  covariance_.bottomRows<2>().setZero();
  covariance_.bottomRightCorner<2, 2>() = other.covariance_.bottomRightCorner<2, 2>();
}

Pose<LocalEnu, Odometry> AlignmentFilter::X_LO() const {
  const Eigen::Vector2d t = mean_.head<2>() - Rotation(mean_(kYaw)) * X_OB_.origin().vector();
  return {t.x(), t.y(), mean_(kYaw)};
}

bool AlignmentFilter::IsSound() const {
  return mean_.allFinite() && covariance_.allFinite() && covariance_.diagonal().minCoeff() > 0.0;
}

}  // namespace v2vouch
