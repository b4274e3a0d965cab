// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/kalman.h"
#include "daemon/local/tracking/initial_sigmas.h"
#include "daemon/local/tracking/track_filter.h"

namespace v2vouch {

void VehicleFilter::StartAt(const PoseMeasurement& z, const Extent& size) {
  constexpr int kRows = LinearizedPose::kRows;
  ExtendedState& state = components_[0].state;
  state.mean << z.x_m, z.y_m, WrapAngle(z.yaw_rad), z.speed_mps, z.yaw_rate_radps, 0.0,
      size.length_m, size.width_m, 0.0, 0.0;
  state.covariance.setZero();
  state.covariance.topLeftCorner<kRows, kRows>() = z.covariance;
  state.covariance(kAccel, kAccel) = kInitialAccelSigma_mps2 * kInitialAccelSigma_mps2;
  state.covariance(ExtendedState::kLength, ExtendedState::kLength) =
      size.length_sigma_m * size.length_sigma_m;
  state.covariance(ExtendedState::kWidth, ExtendedState::kWidth) =
      size.width_sigma_m * size.width_sigma_m;
  AssumeOffsets(state);
  components_[0].weight = 1.0;
  count_ = 1;
  has_driven_ = true;
}

std::optional<Likelihood> VehicleFilter::Evaluate(const PoseMeasurement& z) const {
  return EvaluateExtended(LinearizePose(best().mean.head<kStateSize>(), z), best());
}

bool VehicleFilter::Update(const PoseMeasurement& z) {
  ExtendedState& state = components_[0].state;
  return UpdateExtended(LinearizePose(state.mean.head<kStateSize>(), z), state);
}

TrackFilter TrackFilter::FromPose(const PoseMeasurement& z) {
  TrackFilter filter;
  filter.is_vehicle_ = filter.is_measured_whole_ = true;
  filter.vehicle_.StartAt(z, ClassExtent(filter.object_class_));
  filter.default_yaw_rad_ = WrapAngle(z.yaw_rad);
  return filter;
}

bool TrackFilter::knows_direction() const { return is_vehicle_ && vehicle_.knows_direction(); }

std::optional<Likelihood> TrackFilter::Evaluate(const PoseMeasurement& z,
                                                const FilterSettings& settings) const {
  if (knows_direction()) return vehicle_.Evaluate(z);
  // Position and velocity are what both know.
  const double c = std::cos(z.yaw_rad);
  const double s = std::sin(z.yaw_rad);
  Eigen::Matrix<double, 4, LinearizedPose::kRows> J;  // d(x, y, vx, vy)/d(pose)
  J.setZero();
  J(0, kX) = J(1, kY) = 1.0;
  J.col(kYaw).tail<2>() << -z.speed_mps * s, z.speed_mps * c;
  J.col(kSpeed).tail<2>() << c, s;
  Eigen::Vector4d y;
  y << Eigen::Vector2d(z.x_m, z.y_m) - position_O(),
      z.speed_mps * Eigen::Vector2d(c, s) - velocity_O();
  Eigen::Matrix4d S = J * z.covariance * J.transpose();
  if (is_vehicle_) {  // It stands, or nearly so.
    S.topLeftCorner<2, 2>() += position_covariance();
    S(2, 2) += vehicle_.best().covariance(kSpeed, kSpeed);
    S(3, 3) += vehicle_.best().covariance(kSpeed, kSpeed);
  } else {
    S += point_.covariance();
    if (!settings.point_targets) {
      S(0, 0) += kReflectionSigma_m * kReflectionSigma_m;
      S(1, 1) += kReflectionSigma_m * kReflectionSigma_m;
    }
  }
  return LikelihoodOf(y, S);
}

bool TrackFilter::Update(const PoseMeasurement& z) {
  if (knows_direction()) return vehicle_.Update(z);
  vehicle_.StartAt(z, is_vehicle_ ? vehicle_.best().extent() : ClassExtent(object_class_));
  is_vehicle_ = is_measured_whole_ = true;
  return true;
}

}  // namespace v2vouch
