// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/association/pair_evidence.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

// One message may say so much and no more: a single outlier must not undo a long agreement.
constexpr double kMaxDistance = 25.0;
constexpr double kLatestNis = 9.21;  // Chi-square, 2 dof, 0.99.
constexpr double kMaxGain = 4.0;
constexpr double kMaxLoss = -8.0;
constexpr int kMeanWindow = 20;

double LogNormal(double residual, double sigma) {
  const double distance = std::min(residual * residual / (sigma * sigma), kMaxDistance);
  return -0.5 * distance - 0.5 * std::log(2.0 * kPi * sigma * sigma);
}

// Upper 99.5 % point of chi-square by Wilson and Hilferty (1931), good to 1 % from 4 dof on.
double UpperChiSquare(double dof) {
  constexpr double kZ = 2.576;  // Normal quantile of 99.5 %.
  const double a = 2.0 / (9.0 * dof);
  return dof * std::pow(1.0 - a + kZ * std::sqrt(a), 3);
}

}  // namespace

PairEvidence::PairEvidence(const AssociationConfig& config, const std::optional<BiasPrior>& prior,
                           const PairObservation& first)
    : first_(first.stamp), last_(first.stamp) {
  const double variance = config.bias_sigma_m * config.bias_sigma_m;
  bias_covariance_ = variance * Eigen::Matrix2d::Identity() + first.alignment;
  if (prior) {
    bias_ = prior->mean;
    bias_covariance_ = prior->covariance + first.alignment;
  }
  Add(first, config);
}

void PairEvidence::Add(const PairObservation& observation, const AssociationConfig& config) {
  const double dt_s = std::max(0.0, ToSeconds(observation.stamp - last_));
  last_ = observation.stamp;
  ++observations_;

  const double variance = config.bias_sigma_m * config.bias_sigma_m;
  const Eigen::Matrix2d B0 = variance * Eigen::Matrix2d::Identity() + observation.alignment;
  const double phi = std::exp(-dt_s / config.bias_decay_s);
  bias_ *= phi;
  bias_covariance_ = (phi * phi * bias_covariance_ + (1.0 - phi * phi) * B0).eval();

  const Eigen::Vector2d nu = observation.residual_m - bias_;
  const Eigen::Matrix2d S = bias_covariance_ + observation.sensed + observation.noise;
  const Eigen::Matrix2d S_inverse = S.inverse();
  const double nis = nu.dot(S_inverse * nu);
  latest_nis_ = nis;
  if (nis <= kMaxDistance) {  // Beyond, nothing is learnt: a jump is no bias.
    const Eigen::Matrix2d K = bias_covariance_ * S_inverse;
    bias_ += K * nu;
    const Eigen::Matrix2d reduced = bias_covariance_ - K * S * K.transpose();
    bias_covariance_ = 0.5 * (reduced + reduced.transpose());
  }

  const double weight = 1.0 / std::min(observations_, kMeanWindow);
  mean_nis_ += weight * (std::min(nis, 4.0 * kMaxDistance) - mean_nis_);
  mean_speed_ += weight * (observation.speed_residual_mps - mean_speed_);
  mean_speed_sigma_ += weight * (observation.speed_sigma_mps - mean_speed_sigma_);

  double gain = -0.5 * std::min(nis, kMaxDistance) -
                0.5 * std::log(4.0 * kPi * kPi * S.determinant()) -
                std::log(config.background_per_m2);
  gain += LogNormal(observation.speed_residual_mps, observation.speed_sigma_mps) +
          std::log(config.speed_background_mps);
  if (observation.yaw_residual_rad) {
    gain +=
        LogNormal(*observation.yaw_residual_rad, observation.yaw_sigma_rad) + std::log(2.0 * kPi);
  }
  fading_ = fading_ * std::exp(-dt_s / config.forgetting_s) + std::clamp(gain, kMaxLoss, kMaxGain);
  level_information_ = (B0 + observation.stale).inverse();
  level_ = 0.5 * bias_.dot(level_information_ * bias_);
}

bool PairEvidence::is_nis_consistent() const {
  const double dof = 2.0 * std::min(observations_, kMeanWindow);
  return latest_nis_ <= kLatestNis && mean_nis_ <= UpperChiSquare(dof) / dof * 2.0;
}

bool PairEvidence::is_speed_consistent(const AssociationConfig& config) const {
  return std::abs(mean_speed_) <= config.max_speed_mps + mean_speed_sigma_;
}

}  // namespace v2vouch
