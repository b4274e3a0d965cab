// SPDX-License-Identifier: Apache-2.0
// Which way a vehicle lies and faces: the mixture over its axes, and what of it is shown.
#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/vehicle_filter.h"
#include "daemon/local/tracking/vehicle_terms.h"

namespace v2vouch {
namespace {

constexpr double kLeastWeight = 0.005;
constexpr double kSameAxis_rad = 0.1;
// Across the road either end may be the front.
constexpr double kSurelyTurned_rad = 0.6;
// Driving forwards or backwards is no longer in doubt.
constexpr double kDriving_mps = 1.0;
constexpr double kDrivingSigmas = 3.0;

}  // namespace

// New weights; drops the components that lost, and one of two that have come to agree.
void VehicleFilter::Weigh(std::span<const double> log_likelihoods) {
  const double most = *std::max_element(log_likelihoods.begin(), log_likelihoods.end());
  double sum = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    components_[i].weight *= std::exp(log_likelihoods[i] - most);
    sum += components_[i].weight;
  }
  for (std::size_t i = 0; i < count_; ++i) components_[i].weight /= sum;
  for (std::size_t i = 1; i < count_; ++i) {
    for (std::size_t k = i; k > 0 && components_[k].weight > components_[k - 1].weight; --k) {
      std::swap(components_[k], components_[k - 1]);
    }
  }
  std::size_t kept = 1;
  for (std::size_t i = 1; i < count_; ++i) {
    const double yaw = components_[i].state.mean[kYaw];
    bool is_needed = components_[i].weight >= kLeastWeight;
    for (std::size_t k = 0; k < kept && is_needed; ++k) {
      // Axes have no front: half a turn is the same.
      const double turn = std::abs(std::sin(yaw - components_[k].state.mean[kYaw]));
      is_needed = turn > kSameAxis_rad;
    }
    if (is_needed) components_[kept++] = components_[i];
  }
  count_ = kept;
  sum = 0.0;
  for (std::size_t i = 0; i < count_; ++i) sum += components_[i].weight;
  for (std::size_t i = 0; i < count_; ++i) components_[i].weight /= sum;
}

// What sets off for the first time does so forwards, most likely.
void VehicleFilter::TurnRound() {
  if (has_driven_) return;
  const ExtendedState& state = best();
  const double sigma = std::sqrt(std::max(state.covariance(kSpeed, kSpeed), 0.0));
  if (std::abs(state.mean[kSpeed]) < std::max(kDriving_mps, kDrivingSigmas * sigma)) return;
  has_driven_ = true;
  for (std::size_t i = 0; i < count_; ++i) {
    if (components_[i].state.mean[kSpeed] < 0.0) FaceAbout(components_[i].state);
  }
}

void VehicleFilter::FaceTowards(double yaw_rad) {
  for (std::size_t i = 0; i < count_; ++i) {
    ExtendedState& state = components_[i].state;
    if (std::abs(AngleDifference(state.mean[kYaw], yaw_rad)) > 0.5 * kPi + kSurelyTurned_rad) {
      FaceAbout(state);
    }
  }
}

void VehicleFilter::AssumeClass(ObjectClass from, ObjectClass to,
                                const Eigen::Vector2d& seen_from_O) {
  for (std::size_t i = 0; i < count_; ++i) Rename(from, to, seen_from_O, components_[i].state);
}

void VehicleFilter::Lengthen(double length_m, double sigma_m, const Eigen::Vector2d& seen_from_O) {
  for (std::size_t i = 0; i < count_; ++i) {
    v2vouch::Lengthen(length_m, sigma_m, seen_from_O, components_[i].state);
  }
}

ExtendedState VehicleFilter::Show() const {
  ExtendedState out = best();
  if (count_ == 1) return out;
  const Eigen::Vector2d shown = out.kinematic().velocity();
  const double known = out.covariance(kSpeed, kSpeed);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < count_; ++i) {
    mean += components_[i].weight * components_[i].state.mean.head<2>();
  }
  for (std::size_t i = 0; i < count_; ++i) {
    const Eigen::Vector2d off = components_[i].state.mean.head<2>() - mean;
    out.covariance.topLeftCorner<2, 2>() += components_[i].weight * off * off.transpose();
    // A velocity in another direction than the one shown.
    const Eigen::Vector2d other = components_[i].state.kinematic().velocity() - shown;
    const ExtendedState::Matrix& P = components_[i].state.covariance;
    out.covariance(kSpeed, kSpeed) +=
        components_[i].weight * (other.squaredNorm() + std::max(P(kSpeed, kSpeed) - known, 0.0));
  }
  out.mean.head<2>() = mean;
  return out;
}

Eigen::Matrix2d VehicleFilter::position_covariance() const {
  if (count_ == 1) return best().covariance.topLeftCorner<2, 2>();
  return Show().covariance.topLeftCorner<2, 2>();
}

}  // namespace v2vouch
