// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/measurement_model.h"

namespace v2vouch {
namespace {

// Beyond this a turn is no vehicle's.
constexpr double kMaxYawRate_radps = 20.0;
// Of a sum of two variances: rounding of whoever made the covariance.
constexpr double kAsymmetry = 1e-9;

}  // namespace

LinearizedPose LinearizePose(const StateVector& x, const PoseMeasurement& z) {
  static_assert(kX == 0 && kY == 1 && kYaw == 2 && kSpeed == 3 && kYawRate == 4);
  LinearizedPose out;
  out.y << z.x_m - x[kX], z.y_m - x[kY], WrapAngle(z.yaw_rad - x[kYaw]), z.speed_mps - x[kSpeed],
      z.yaw_rate_radps - x[kYawRate];
  out.R = z.covariance;
  return out;
}

std::optional<Reason> FaultOf(const PoseMeasurement& z) {
  if (!std::isfinite(z.x_m) || !std::isfinite(z.y_m) || !std::isfinite(z.yaw_rad) ||
      !std::isfinite(z.speed_mps) || !std::isfinite(z.yaw_rate_radps) ||
      !z.covariance.allFinite()) {
    return Reason::kNotFinite;
  }
  if (std::abs(z.x_m) > kMaxPosition_m || std::abs(z.y_m) > kMaxPosition_m ||
      std::abs(z.speed_mps) > kMaxSpeed_mps || std::abs(z.yaw_rate_radps) > kMaxYawRate_radps) {
    return Reason::kOutOfRange;
  }
  const auto& R = z.covariance;
  for (int i = 0; i < LinearizedPose::kRows; ++i) {
    for (int j = 0; j < i; ++j) {
      if (std::abs(R(i, j) - R(j, i)) > kAsymmetry * (R(i, i) + R(j, j))) {
        return Reason::kOutOfRange;
      }
    }
  }
  const Eigen::LLT<LinearizedPose::Covariance> llt(R);
  if (llt.info() != Eigen::Success) return Reason::kOutOfRange;
  return std::nullopt;
}

}  // namespace v2vouch
