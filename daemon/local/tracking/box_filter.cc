// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/kalman.h"
#include "daemon/local/tracking/initial_sigmas.h"
#include "daemon/local/tracking/track_filter.h"

namespace v2vouch {
namespace {

// What one box leaves open: anything from standing to motorway speed lies within three sigma.
constexpr double kInitialSpeedSigma_mps = 10.0;
// Detectors turn one box in twenty by a quarter, or cut it short. Such a value is as likely as
// clutter's, which spreads over these spans: it must not tear a track from its vehicle.
constexpr double kOddShare = 0.05;
constexpr double kAxisSpan_rad = kPi;
constexpr double kLengthSpan_m = 2.5;
constexpr double kWidthSpan_m = 0.8;
// So do velocities, where a detector tells any: along each axis of O.
constexpr double kVelocitySpan_mps = 30.0;
// Motion and detector must both say that the front is the other end.
constexpr double kBackwards_mps = 1.0;
constexpr double kBackwardsSigmas = 3.0;

// -2 ln of the density against a clutter value's, which is spread evenly over `span`.
double Surprise(double difference, double variance, double span) {
  const double density =
      std::exp(-0.5 * difference * difference / variance) / std::sqrt(2.0 * kPi * variance);
  return -2.0 * std::log((1.0 - kOddShare) * density * span + kOddShare);
}

// The same for a velocity whose innovation is `y` with covariance `S`.
double VelocitySurprise(const Eigen::Vector2d& y, const Eigen::Matrix2d& S) {
  const auto likelihood = LikelihoodOf(y, S);
  if (!likelihood) return 0.0;
  const double density =
      std::exp(-0.5 * (likelihood->distance_squared + likelihood->log_det)) / (2.0 * kPi);
  return -2.0 *
         std::log((1.0 - kOddShare) * density * kVelocitySpan_mps * kVelocitySpan_mps + kOddShare);
}

// A velocity that does not fit the motion at all belongs to another vehicle's box, or to none.
constexpr double kVelocityGate = 16.0;

}  // namespace

void VehicleFilter::StartAt(const BoxMeasurement& z) {
  ExtendedState& state = components_[0].state;
  state.mean << z.x_m, z.y_m, WrapAngle(z.yaw_rad), 0.0, 0.0, 0.0, z.length_m, z.width_m, 0.0, 0.0;
  state.covariance.setZero();
  state.covariance.topLeftCorner<2, 2>() = z.position_covariance;
  const auto set = [&state](int k, double sigma) { state.covariance(k, k) = sigma * sigma; };
  set(kYaw, z.yaw_sigma_rad);
  set(kSpeed, kInitialSpeedSigma_mps);
  set(kYawRate, kInitialYawRateSigma_radps);
  set(kAccel, kInitialAccelSigma_mps2);
  set(ExtendedState::kLength, z.length_sigma_m);
  set(ExtendedState::kWidth, z.width_sigma_m);
  AssumeOffsets(state);
  components_[0].weight = 1.0;
  count_ = 1;
  has_driven_ = true;
  is_size_open_ = true;  // Measured, not a class's.
  if (!z.velocity_O_mps) return;
  const Eigen::Vector2d forward(std::cos(z.yaw_rad), std::sin(z.yaw_rad));
  const double variance = forward.dot(z.velocity_covariance * forward);
  const double speed_mps = z.velocity_O_mps->dot(forward);
  AssumeSpeed(speed_mps, std::sqrt(variance));
  // Motion tells front from rear, where the detector does not.
  if (!z.has_front && speed_mps < -kBackwardsSigmas * std::sqrt(variance)) FaceAbout(state);
}

void VehicleFilter::AssumeSpeed(double speed_mps, double sigma_mps) {
  ExtendedState& state = components_[0].state;
  state.mean[kSpeed] = speed_mps;
  state.covariance(kSpeed, kSpeed) = sigma_mps * sigma_mps;
}

std::optional<Likelihood> VehicleFilter::Evaluate(const BoxMeasurement& z) const {
  const ExtendedState& state = best();
  const Eigen::Vector2d y = Eigen::Vector2d(z.x_m, z.y_m) - state.mean.head<2>();
  auto likelihood = LikelihoodOf(
      y, Eigen::Matrix2d(state.covariance.topLeftCorner<2, 2>() + z.position_covariance));
  if (!likelihood) return std::nullopt;
  const auto variance = [&state](int k, double sigma) {
    return state.covariance(k, k) + sigma * sigma;
  };
  likelihood->log_det += Surprise(AxisDifference(z.yaw_rad, state.mean[kYaw]),
                                  variance(kYaw, z.yaw_sigma_rad), kAxisSpan_rad);
  likelihood->log_det +=
      Surprise(z.length_m - state.mean[ExtendedState::kLength],
               variance(ExtendedState::kLength, z.length_sigma_m), kLengthSpan_m);
  likelihood->log_det += Surprise(z.width_m - state.mean[ExtendedState::kWidth],
                                  variance(ExtendedState::kWidth, z.width_sigma_m), kWidthSpan_m);
  if (z.velocity_O_mps) {
    const Linearized model = LinearizeBoxVelocity(state.mean.head<kStateSize>(), z);
    const Eigen::Matrix<double, 2, kStateSize> H = model.H;
    likelihood->log_det += VelocitySurprise(
        model.y, H * state.covariance.topLeftCorner<kStateSize, kStateSize>() * H.transpose() +
                     z.velocity_covariance);
  }
  return likelihood;
}

bool VehicleFilter::Update(const BoxMeasurement& z) {
  ExtendedState& state = components_[0].state;
  const double turn = AxisDifference(z.yaw_rad, state.mean[kYaw]);
  const bool has_axis = std::abs(turn) < kOddAxis_rad;
  const int rows = has_axis ? 5 : 4;
  Linearized model;
  model.y.resize(rows);
  model.H.setZero(rows, kStateSize);
  model.E.setZero(rows, 2);
  model.R.setZero(rows, rows);
  model.y.head<2>() = Eigen::Vector2d(z.x_m, z.y_m) - state.mean.head<2>();
  model.H(0, kX) = model.H(1, kY) = 1.0;
  model.R.topLeftCorner<2, 2>() = z.position_covariance;
  model.y[2] = z.length_m - state.mean[ExtendedState::kLength];
  model.y[3] = z.width_m - state.mean[ExtendedState::kWidth];
  model.E(2, 0) = model.E(3, 1) = 1.0;
  model.R(2, 2) = z.length_sigma_m * z.length_sigma_m;
  model.R(3, 3) = z.width_sigma_m * z.width_sigma_m;
  if (has_axis) {
    model.y[4] = turn;
    model.H(4, kYaw) = 1.0;
    model.R(4, 4) = z.yaw_sigma_rad * z.yaw_sigma_rad;
  }
  if (!UpdateExtended(model, state)) return false;
  if (z.velocity_O_mps) {
    const Linearized velocity = LinearizeBoxVelocity(state.mean.head<kStateSize>(), z);
    const auto fit = EvaluateExtended(velocity, state);
    if (fit && fit->distance_squared < kVelocityGate && !UpdateExtended(velocity, state)) {
      return false;
    }
  }
  const double sigma_mps = std::sqrt(std::max(state.covariance(kSpeed, kSpeed), 0.0));
  if (state.mean[kSpeed] < -(kBackwards_mps + kBackwardsSigmas * sigma_mps) &&
      std::cos(z.yaw_rad - state.mean[kYaw]) < 0.0) {
    FaceAbout(state);
  }
  return true;
}

TrackFilter TrackFilter::FromBox(const BoxMeasurement& z) {
  TrackFilter filter;
  filter.is_vehicle_ = filter.is_measured_whole_ = true;
  filter.vehicle_.StartAt(z);
  filter.default_yaw_rad_ = WrapAngle(z.yaw_rad);
  return filter;
}

std::optional<Likelihood> TrackFilter::Evaluate(const BoxMeasurement& z,
                                                const FilterSettings& settings) const {
  if (knows_direction()) return vehicle_.Evaluate(z);
  Eigen::Matrix2d S = position_covariance() + z.position_covariance;
  if (!is_vehicle_ && !settings.point_targets) {
    S += kReflectionSigma_m * kReflectionSigma_m * Eigen::Matrix2d::Identity();
  }
  return LikelihoodOf(Eigen::Vector2d(Eigen::Vector2d(z.x_m, z.y_m) - position_O()), S);
}

bool TrackFilter::Update(const BoxMeasurement& z) {
  if (knows_direction()) return vehicle_.Update(z);
  // Only the velocity of what is no vehicle yet, or has no axis, is known better than the box.
  const Eigen::Vector2d velocity = velocity_O();
  const double variance = is_vehicle_ ? vehicle_.best().covariance(kSpeed, kSpeed)
                                      : 0.5 * point_.covariance().bottomRightCorner<2, 2>().trace();
  vehicle_.StartAt(z);
  is_vehicle_ = is_measured_whole_ = true;
  if (z.velocity_O_mps) return true;
  const double sigma_mps = std::sqrt(std::max(variance, 0.0));
  if (sigma_mps < kInitialSpeedSigma_mps) {
    vehicle_.AssumeSpeed(velocity.dot(Eigen::Vector2d(std::cos(z.yaw_rad), std::sin(z.yaw_rad))),
                         sigma_mps);
  }
  return true;
}

}  // namespace v2vouch
