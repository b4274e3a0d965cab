// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/measurement_model.h"

namespace v2vouch {
namespace {

// Of a sum of two variances: rounding in the maker of the covariance.
constexpr double kAsymmetry = 1e-9;
// A size or a standard deviation beyond this is no vehicle's.
constexpr double kMostFigure = 100.0;

std::optional<Reason> FaultOf(const Eigen::Matrix2d& R) {
  if (!R.allFinite()) return Reason::kNotFinite;
  if (std::abs(R(0, 1) - R(1, 0)) > kAsymmetry * (R(0, 0) + R(1, 1))) return Reason::kOutOfRange;
  const Eigen::LLT<Eigen::Matrix2d> llt(R);
  if (llt.info() != Eigen::Success) return Reason::kOutOfRange;
  return std::nullopt;
}

}  // namespace

double AxisDifference(double a_rad, double b_rad) {
  const double d = WrapAngle(a_rad - b_rad);
  if (d > 0.5 * kPi) return d - kPi;
  return d <= -0.5 * kPi ? d + kPi : d;
}

Linearized LinearizeBoxVelocity(const StateVector& x, const BoxMeasurement& z) {
  const Eigen::Vector2d forward(std::cos(x[kYaw]), std::sin(x[kYaw]));
  Linearized model;
  model.y = *z.velocity_O_mps - x[kSpeed] * forward;
  model.H.setZero(2, kStateSize);
  model.E.setZero(2, 2);
  model.H.block<2, 1>(0, kYaw) = x[kSpeed] * Eigen::Vector2d(-forward.y(), forward.x());
  model.H.block<2, 1>(0, kSpeed) = forward;
  model.R = z.velocity_covariance;
  return model;
}

Linearized LinearizeBox(const StateVector& x, const BoxMeasurement& z) {
  const double turn = AxisDifference(z.yaw_rad, x[kYaw]);
  const bool has_axis = std::abs(turn) < kOddAxis_rad;
  const int rows = 2 + (has_axis ? 1 : 0) + (z.velocity_O_mps ? 2 : 0);
  Linearized model;
  model.y.resize(rows);
  model.H.setZero(rows, kStateSize);
  model.E.setZero(rows, 2);
  model.R.setZero(rows, rows);
  model.y.head<2>() = Eigen::Vector2d(z.x_m, z.y_m) - x.head<2>();
  model.H(0, kX) = model.H(1, kY) = 1.0;
  model.R.topLeftCorner<2, 2>() = z.position_covariance;
  int row = 2;
  if (has_axis) {
    model.y[row] = turn;
    model.H(row, kYaw) = 1.0;
    model.R(row, row) = z.yaw_sigma_rad * z.yaw_sigma_rad;
    ++row;
  }
  if (z.velocity_O_mps) {
    const Linearized velocity = LinearizeBoxVelocity(x, z);
    model.y.segment<2>(row) = velocity.y;
    model.H.middleRows<2>(row) = velocity.H;
    model.R.block<2, 2>(row, row) = velocity.R;
  }
  return model;
}

std::optional<Reason> FaultOf(const BoxMeasurement& z) {
  for (const double value : {z.x_m, z.y_m, z.yaw_rad, z.length_m, z.width_m, z.yaw_sigma_rad,
                             z.length_sigma_m, z.width_sigma_m, z.log_odds}) {
    if (!std::isfinite(value)) return Reason::kNotFinite;
  }
  if (std::abs(z.x_m) > kMaxPosition_m || std::abs(z.y_m) > kMaxPosition_m) {
    return Reason::kOutOfRange;
  }
  for (const double value :
       {z.length_m, z.width_m, z.yaw_sigma_rad, z.length_sigma_m, z.width_sigma_m}) {
    if (value <= 0.0 || value > kMostFigure) return Reason::kOutOfRange;
  }
  if (const auto fault = FaultOf(z.position_covariance)) return fault;
  if (!z.velocity_O_mps) return std::nullopt;
  if (!z.velocity_O_mps->allFinite()) return Reason::kNotFinite;
  if (z.velocity_O_mps->norm() > kMaxSpeed_mps) return Reason::kOutOfRange;
  return FaultOf(z.velocity_covariance);
}

}  // namespace v2vouch
