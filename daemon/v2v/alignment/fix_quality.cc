// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/alignment/fix_quality.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/v2v/alignment/flat_earth.h"

namespace v2vouch {
namespace {

// A fix that says nothing of its accuracy; phone grade (95 % about 5 m under open sky).
constexpr double kUnknownSigma_m = 2.5;
// Beyond this a fix does not help to place a vehicle 100 m away.
constexpr double kUselessSigma_m = 50.0;
constexpr double kUnknownVelocitySigma_mps = 0.2;
constexpr double kMinVelocitySigma_mps = 0.05;
constexpr double kUnknownYawSigma_rad = 0.05;

double SigmaOr(double sigma, double fallback, double floor) {
  return std::isfinite(sigma) && sigma > 0.0 ? std::max(sigma, floor) : fallback;
}

}  // namespace

std::optional<Eigen::Matrix2d> UsableCovariance(const GnssFix& fix, double floor_m) {
  Eigen::Matrix2d C = fix.covariance_enu.topLeftCorner<2, 2>();
  if (!C.allFinite()) return std::nullopt;
  // One axis known: as good as the other, for lack of better.
  if (C(0, 0) == 0.0 && C(1, 1) > 0.0) C(0, 0) = C(1, 1);
  if (C(1, 1) == 0.0 && C(0, 0) > 0.0) C(1, 1) = C(0, 0);
  if (C.isZero(0.0)) C = kUnknownSigma_m * kUnknownSigma_m * Eigen::Matrix2d::Identity();
  C = (0.5 * (C + C.transpose())).eval();
  const double mean = 0.5 * C.trace();
  const double spread = std::hypot(0.5 * (C(0, 0) - C(1, 1)), C(0, 1));
  const double smallest = mean - spread;
  // Rounding may leave a small eigenvalue a little below 0; more than that is no covariance.
  if (C(0, 0) < 0.0 || C(1, 1) < 0.0 || smallest < -1e-6 * mean) return std::nullopt;
  if (mean + spread > kUselessSigma_m * kUselessSigma_m) return std::nullopt;
  if (smallest < floor_m * floor_m) {
    C += (floor_m * floor_m - smallest) * Eigen::Matrix2d::Identity();
  }
  return C;
}

bool HasPosition(const GnssFix& fix) {
  return fix.fix_type != FixType::kNone && std::isfinite(fix.position.latitude_rad) &&
         std::isfinite(fix.position.longitude_rad) && std::isfinite(fix.position.height_m) &&
         std::abs(fix.position.latitude_rad) <= kPi / 2.0 &&
         std::abs(fix.position.longitude_rad) <= 2.0 * kPi;
}

FixInPlane InPlane(const LocalPlane& plane, const GnssFix& fix,
                   const Eigen::Matrix2d& covariance_en, double yaw_floor_rad) {
  // East and north at the fix are not quite L's axes: meridians converge.
  const double turn = ConvergenceAt(plane, fix.position);
  const Eigen::Matrix2d R_LN = Pose<LocalEnu, LocalEnu>(0.0, 0.0, turn).rotation();
  FixInPlane in_plane;
  in_plane.p_L = Flat(plane, fix.position);
  in_plane.covariance = R_LN * covariance_en * R_LN.transpose();
  if (fix.velocity_en_mps && fix.velocity_en_mps->allFinite()) {
    in_plane.v_L = R_LN * *fix.velocity_en_mps;
    in_plane.velocity_sigma_mps =
        SigmaOr(fix.velocity_sigma_mps, kUnknownVelocitySigma_mps, kMinVelocitySigma_mps);
  }
  if (fix.yaw_rad && std::isfinite(*fix.yaw_rad)) {
    in_plane.yaw_L_rad = WrapAngle(*fix.yaw_rad + turn);
    in_plane.yaw_sigma_rad = SigmaOr(fix.yaw_sigma_rad, kUnknownYawSigma_rad, yaw_floor_rad + 1e-4);
  }
  return in_plane;
}

}  // namespace v2vouch
