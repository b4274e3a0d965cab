// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/priority/priority_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

constexpr double kMaxStep_s = 0.1;  // CtraStep's own limit.
constexpr int kMostSteps = 100;     // What is longer, PredictCtra makes short.
constexpr double kDoubtSpeed_mps = 1.5;
constexpr double kDoubtYaw_rad = FromDegrees(10.0);
constexpr double kLowSpeed_mps = 1.0;
constexpr double kLowSpeedYawSigma_rad = 0.2;  // A heading frozen at standstill is only roughly so.

using Vector = PriorityFilter::Vector;
using Matrix = PriorityFilter::Matrix;
template <int Rows>
using Rows_t = Eigen::Matrix<double, Rows, PriorityFilter::kSize>;

// Joseph form, (I - K H) P (I - K H)' + K R K', which rounding of the gain changes to second order
// only. I - K H is never multiplied out: with one or two rows, P - K (H P) costs a tenth of it.
// What rounding leaves is some 1e-16 of P, far below any R here; is_healthy() looks for the rest.
// Coefficient by coefficient: for sizes like these, packing for the blocked product costs more than
// the product itself.
template <class Innovation, class Jacobian, class Noise>
bool JosephUpdate(const Innovation& y, const Jacobian& H, const Noise& R, Vector& x, Matrix& P) {
  const auto PHt = P.lazyProduct(H.transpose()).eval();
  const auto S = (H.lazyProduct(PHt) + R).eval();
  const auto factor = S.llt();
  if (factor.info() != Eigen::Success) return false;
  const auto K = factor.solve(PHt.transpose()).transpose().eval();
  const Vector step = K.lazyProduct(y);
  if (!step.allFinite()) return false;
  x += step;
  x[kYaw] = WrapAngle(x[kYaw]);
  Matrix left = P;  // (I - K H) P
  left -= K.lazyProduct(PHt.transpose());
  const auto back = (left.lazyProduct(H.transpose()) - K.lazyProduct(R)).eval();
  left -= back.lazyProduct(K.transpose());
  P = 0.5 * (left + left.transpose());
  return true;
}

// One scalar row, gated.
bool UpdateRow(double y, const Rows_t<1>& H, double sigma, double gate, Vector& x, Matrix& P) {
  const double S = H.lazyProduct(P).eval().dot(H) + sigma * sigma;
  if (!(y * y <= gate * S)) return false;
  const Eigen::Matrix<double, 1, 1> innovation(y);
  const Eigen::Matrix<double, 1, 1> R(sigma * sigma);
  return JosephUpdate(innovation, H, R, x, P);
}

// The same motion with the vehicle's other end as its front.
void TurnRound(Vector& x, Matrix& P) {
  x[kYaw] = WrapAngle(x[kYaw] + kPi);
  for (const int i : {static_cast<int>(kSpeed), static_cast<int>(kAccel)}) {
    x[i] = -x[i];
    P.row(i) = -P.row(i);
    P.col(i) = -P.col(i);
  }
}

}  // namespace

PriorityFilter::PriorityFilter(const KinematicState& vehicle, Timestamp stamp,
                               const Eigen::Vector2d& bias, const Eigen::Matrix2d& bias_covariance,
                               double frame_yaw_sigma_rad, const PriorityFilterConfig& config)
    : stamp_(stamp),
      p_ref_O_(vehicle.mean.head<2>()),
      frame_yaw_variance_(frame_yaw_sigma_rad * frame_yaw_sigma_rad) {
  mean_.head<kStateSize>() = vehicle.mean;
  covariance_.setZero();
  covariance_.topLeftCorner<kStateSize, kStateSize>() = vehicle.covariance;
  ResetErrors(bias_covariance, config);
  mean_.segment<2>(kBiasX) = bias;
}

void PriorityFilter::ResetErrors(const Eigen::Matrix2d& bias_covariance,
                                 const PriorityFilterConfig& config) {
  constexpr int kErrors = kSize - kStateSize;
  mean_.tail<kErrors>().setZero();
  covariance_.rightCols<kErrors>().setZero();
  covariance_.bottomRows<kErrors>().setZero();
  covariance_.block<2, 2>(kBiasX, kBiasX) = bias_covariance;
  covariance_(kSpeedError, kSpeedError) = config.speed_error_mps * config.speed_error_mps;
  covariance_(kYawError, kYawError) = config.yaw_error_rad * config.yaw_error_rad;
  covariance_(kFrameYaw, kFrameYaw) = std::max(frame_yaw_variance_, 1e-8);
}

void PriorityFilter::PredictTo(Timestamp stamp, const PriorityFilterConfig& config) {
  double left_s = ToSeconds(stamp - stamp_);
  if (!(left_s > 0.0)) return;
  stamp_ = stamp;
  constexpr int kErrors = kSize - kStateSize;
  Eigen::Matrix<double, kErrors, 1> decay_s, variance;
  decay_s << config.bias_decay_s, config.bias_decay_s, config.error_decay_s, config.error_decay_s,
      config.bias_decay_s;
  variance << config.bias_sigma_m * config.bias_sigma_m, config.bias_sigma_m * config.bias_sigma_m,
      config.speed_error_mps * config.speed_error_mps, config.yaw_error_rad * config.yaw_error_rad,
      std::max(frame_yaw_variance_, 1e-8);
  const Eigen::Matrix<double, kErrors, 1> phi = (-left_s * decay_s.cwiseInverse()).array().exp();

  // The vehicle by the common motion model, in its own sub-steps, so that the Jacobian for the
  // cross terms is the one the covariance was moved with.
  KinematicState vehicle = kinematics();
  StateMatrix F = StateMatrix::Identity();
  for (int steps = 0; left_s > 1e-9; ++steps) {
    StateMatrix step;
    if (steps == kMostSteps) {
      PredictCtra(vehicle, left_s, config.motion, &step);
      F = (step * F).eval();
      break;
    }
    const double dt_s = std::min(left_s, kMaxStep_s);
    CtraStep(vehicle.mean, dt_s, config.motion, &step);
    PredictCtra(vehicle, dt_s, config.motion);
    F = (step * F).eval();
    left_s -= dt_s;
  }
  const Eigen::Matrix<double, kStateSize, kErrors> cross =
      F * covariance_.topRightCorner<kStateSize, kErrors>() * phi.asDiagonal();
  mean_.head<kStateSize>() = vehicle.mean;
  mean_.tail<kErrors>() = mean_.tail<kErrors>().cwiseProduct(phi).eval();
  covariance_.topLeftCorner<kStateSize, kStateSize>() = vehicle.covariance;
  covariance_.topRightCorner<kStateSize, kErrors>() = cross;
  covariance_.bottomLeftCorner<kErrors, kStateSize>() = cross.transpose();
  auto errors = covariance_.bottomRightCorner<kErrors, kErrors>();
  errors = (phi.asDiagonal() * errors * phi.asDiagonal()).eval();
  errors.diagonal() += variance.cwiseProduct((1.0 - phi.array().square()).matrix());
}

bool PriorityFilter::Update(const Linearized& measurement) {
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, kSize, 0, Linearized::kMaxRows, kSize>;
  Jacobian H = Jacobian::Zero(measurement.H.rows(), kSize);
  H.leftCols<kStateSize>() = measurement.H;
  return JosephUpdate(measurement.y, H, measurement.R, mean_, covariance_);
}

ClaimFit PriorityFilter::Update(const ClaimInOdometry& claim, const PriorityFilterConfig& config) {
  FaceAs(claim);
  ClaimFit fit;
  // Position with bias and frame rotation about p_ref.
  const Eigen::Vector2d lever = mean_.head<2>() - p_ref_O_;
  const double theta = mean_[kFrameYaw];
  const Eigen::Vector2d turn(-lever.y(), lever.x());
  Rows_t<2> H = Rows_t<2>::Zero();
  H.leftCols<2>() << 1.0, -theta, theta, 1.0;
  H.block<2, 2>(0, kBiasX).setIdentity();
  H.col(kFrameYaw) = turn;
  const Eigen::Vector2d y = claim.p_O - (mean_.head<2>() + bias() + theta * turn);
  const Eigen::Matrix2d& R = claim.noise;
  const Eigen::Matrix2d S = H * covariance_ * H.transpose() + R;
  fit.position_nis = y.dot(S.inverse() * y);
  if (!(fit.position_nis <= config.position_gate)) return fit;
  if (!JosephUpdate(y, H, R, mean_, covariance_)) return fit;
  fit.is_used = true;
  fit.is_velocity_used = TakeMotion(claim, config);

  const double size_m = bias().norm();
  if (size_m > config.max_bias_m) mean_.segment<2>(kBiasX) *= config.max_bias_m / size_m;
  return fit;
}

bool PriorityFilter::UpdateMotion(const ClaimInOdometry& claim,
                                  const PriorityFilterConfig& config) {
  FaceAs(claim);
  return TakeMotion(claim, config);
}

void PriorityFilter::FaceAs(const ClaimInOdometry& claim) {
  const double as_is = std::abs(mean_[kSpeed] - claim.speed_mps);
  const double turned = std::abs(mean_[kSpeed] + claim.speed_mps);
  const bool is_opposite =
      claim.has_course && std::abs(AngleDifference(claim.yaw_rad, mean_[kYaw])) > 0.5 * kPi;
  if (is_opposite && (turned < as_is || std::abs(mean_[kSpeed]) < kLowSpeed_mps)) {
    TurnRound(mean_, covariance_);
  }
}

bool PriorityFilter::TakeMotion(const ClaimInOdometry& claim, const PriorityFilterConfig& config) {
  Rows_t<1> row = Rows_t<1>::Zero();
  row[kSpeed] = 1.0;
  row[kSpeedError] = 1.0;
  bool is_used = UpdateRow(claim.speed_mps - mean_[kSpeed] - mean_[kSpeedError], row,
                           std::max(config.speed_sigma_mps, claim.speed_sigma_mps), config.row_gate,
                           mean_, covariance_);
  if (claim.has_course) {
    row.setZero();
    row[kYaw] = 1.0;
    row[kYawError] = 1.0;
    row[kFrameYaw] = 1.0;
    double sigma_rad = std::max(config.yaw_sigma_rad, claim.yaw_sigma_rad);
    if (std::abs(claim.speed_mps) < kLowSpeed_mps) {
      sigma_rad = std::max(sigma_rad, kLowSpeedYawSigma_rad);
    }
    const double y_yaw =
        AngleDifference(claim.yaw_rad - mean_[kYawError] - mean_[kFrameYaw], mean_[kYaw]);
    is_used &= UpdateRow(y_yaw, row, sigma_rad, config.row_gate, mean_, covariance_);
  }

  // What the vehicle says of its manoeuvre; only where it fits.
  row.setZero();
  row[kYawRate] = 1.0;
  UpdateRow(claim.yaw_rate_radps - mean_[kYawRate], row, config.yaw_rate_sigma_radps,
            config.row_gate, mean_, covariance_);
  row.setZero();
  row[kAccel] = 1.0;
  UpdateRow(claim.accel_mps2 - mean_[kAccel], row, config.accel_sigma_mps2, config.row_gate, mean_,
            covariance_);
  return is_used;
}

Eigen::Matrix2d PriorityFilter::LackOf(const Eigen::Matrix2d& least) const {
  const Eigen::Matrix2d lacking = least - covariance_.topLeftCorner<2, 2>();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> parts;
  parts.computeDirect(lacking);
  const Eigen::Vector2d positive = parts.eigenvalues().cwiseMax(0.0);
  if (!positive.allFinite()) return Eigen::Matrix2d::Zero();
  return parts.eigenvectors() * positive.asDiagonal() * parts.eigenvectors().transpose();
}

void PriorityFilter::DoubtVelocity() {
  covariance_(kSpeed, kSpeed) += kDoubtSpeed_mps * kDoubtSpeed_mps;
  covariance_(kYaw, kYaw) += kDoubtYaw_rad * kDoubtYaw_rad;
}

void PriorityFilter::ResetVehicle(const KinematicState& vehicle) {
  mean_.head<kStateSize>() = vehicle.mean;
  covariance_.topRows<kStateSize>().setZero();
  covariance_.leftCols<kStateSize>().setZero();
  covariance_.topLeftCorner<kStateSize, kStateSize>() = vehicle.covariance;
}

KinematicState PriorityFilter::kinematics() const {
  return {mean_.head<kStateSize>(), covariance_.topLeftCorner<kStateSize, kStateSize>()};
}

double PriorityFilter::position_sigma_m() const {
  const Eigen::Matrix2d P = covariance_.topLeftCorner<2, 2>();
  const double half_trace = 0.5 * P.trace();
  const double radius = std::hypot(0.5 * (P(0, 0) - P(1, 1)), P(0, 1));
  return std::sqrt(std::max(0.0, half_trace + radius));
}

bool PriorityFilter::is_healthy() const {
  return mean_.allFinite() && covariance_.allFinite() &&
         (covariance_.diagonal().array() > 0.0).all();
}

}  // namespace v2vouch
