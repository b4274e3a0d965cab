// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/models/extent.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/extent_limits.h"
#include "daemon/common/models/kalman.h"
#include "daemon/common/models/radar_outline.h"

namespace v2vouch {
namespace {

// 2 cm after one second: nothing real, it keeps the filter able to change its mind.
constexpr double kSizePsd = 4e-4;

constexpr int kLength = ExtendedState::kLength;
constexpr int kWidth = ExtendedState::kWidth;
constexpr int kDepth = ExtendedState::kDepth;
constexpr int kAside = ExtendedState::kAside;
constexpr int kOthers = ExtendedState::kSize - kStateSize;
// Longer vehicles turn more slowly, half of that from this speed on.
constexpr double kUsualLength_m = 5.0;
constexpr double kLongSpeed_mps = 10.0;
// How long the offsets last: scatterers change with the aspect.
constexpr double kDepthDecay_s = 3.0;
constexpr double kAsideDecay_s = 5.0;

// First-order Gauss-Markov: x = phi x.
void Decay(int k, double sigma, double phi, ExtendedState& state) {
  state.mean[k] *= phi;
  state.covariance.row(k) *= phi;
  state.covariance.col(k) *= phi;
  state.covariance(k, k) += sigma * sigma * (1.0 - phi * phi);
}

}  // namespace

Extent ClassExtent(ObjectClass object_class) {
  // Passenger cars after the European and US fleets' usual figures; lorries and buses after
  // Directive 96/53/EC: 12 m x 2.55 m, articulated lorries 16.5 m, which are most of those on
  // motorways, and smaller ones in town.
  switch (object_class) {
    case ObjectClass::kCar:
      return {4.5, 1.8, 0.4, 0.1};
    case ObjectClass::kVan:
      return {5.2, 2.0, 0.6, 0.15};
    case ObjectClass::kTruck:
      return {11.0, 2.5, 3.5, 0.15};
    case ObjectClass::kBus:
      return {12.0, 2.55, 1.5, 0.1};
    case ObjectClass::kMotorcycle:
      return {2.2, 0.8, 0.2, 0.15};
    case ObjectClass::kPedestrian:
      return {0.5, 0.5, 0.15, 0.15};
    case ObjectClass::kCyclist:
      return {1.8, 0.6, 0.2, 0.15};
    case ObjectClass::kUnknown:
      break;
  }
  return {4.6, 1.85, 0.8, 0.2};
}

KinematicState ExtendedState::kinematic() const {
  return {mean.head<kStateSize>(), covariance.topLeftCorner<kStateSize, kStateSize>()};
}

Extent ExtendedState::extent() const {
  return {mean[kLength], mean[kWidth], std::sqrt(std::max(covariance(kLength, kLength), 0.0)),
          std::sqrt(std::max(covariance(kWidth, kWidth), 0.0))};
}

Extent ExtendedState::assumed_extent() const { return {mean[kLength], mean[kWidth], 0.0, 0.0}; }

void AssumeOffsets(ExtendedState& state) {
  state.mean.tail<2>().setZero();
  state.covariance.bottomRows<2>().setZero();
  state.covariance.rightCols<2>().setZero();
  state.covariance(kDepth, kDepth) = kDepthOffsetSigma_m * kDepthOffsetSigma_m;
  state.covariance(kAside, kAside) = kAsideOffsetSigma * kAsideOffsetSigma;
}

namespace {

// The longer a vehicle is the less lateral acceleration it drives with: at speed, not where it
// turns off at a walk.
MotionNoise NoiseOf(double length_m, double speed_mps, const MotionNoise& noise) {
  MotionNoise out = noise;
  const double at_speed =
      speed_mps * speed_mps / (speed_mps * speed_mps + kLongSpeed_mps * kLongSpeed_mps);
  const double ratio = kUsualLength_m / std::max(length_m, kUsualLength_m);
  const double share = 1.0 - (1.0 - ratio) * at_speed;
  out.yaw_accel_psd *= share * share;
  out.slip_psd *= share * share;
  return out;
}

}  // namespace

void PredictExtended(ExtendedState& state, double dt_s, const MotionNoise& noise) {
  KinematicState motion = state.kinematic();
  StateMatrix F;
  PredictCtra(motion, dt_s, NoiseOf(state.mean[ExtendedState::kLength], state.mean[kSpeed], noise),
              &F);
  const Eigen::Matrix<double, kStateSize, kOthers> cross =
      F * state.covariance.topRightCorner<kStateSize, kOthers>();
  state.mean.head<kStateSize>() = motion.mean;
  state.covariance.topLeftCorner<kStateSize, kStateSize>() = motion.covariance;
  state.covariance.topRightCorner<kStateSize, kOthers>() = cross;
  state.covariance.bottomLeftCorner<kOthers, kStateSize>() = cross.transpose();
  Decay(kDepth, kDepthOffsetSigma_m, std::exp(-dt_s / kDepthDecay_s), state);
  Decay(kAside, kAsideOffsetSigma, std::exp(-dt_s / kAsideDecay_s), state);
  state.covariance(ExtendedState::kLength, ExtendedState::kLength) += kSizePsd * dt_s;
  state.covariance(ExtendedState::kWidth, ExtendedState::kWidth) += 0.1 * kSizePsd * dt_s;
}

namespace {

using WholeJacobianMatrix = Eigen::Matrix<double, Eigen::Dynamic, ExtendedState::kSize, 0,
                                          Linearized::kMaxRows, ExtendedState::kSize>;

WholeJacobianMatrix WholeJacobian(const Linearized& measurement) {
  WholeJacobianMatrix H(measurement.y.size(), ExtendedState::kSize);
  if (measurement.O.rows() == 0) {
    H << measurement.H, measurement.E, Linearized::ExtentJacobian::Zero(measurement.y.size(), 2);
  } else {
    H << measurement.H, measurement.E, measurement.O;
  }
  return H;
}

// The model's own value leaves the offsets out.
Linearized::Vector Innovation(const Linearized& measurement, const ExtendedState& state) {
  if (measurement.O.rows() == 0) return measurement.y;
  return measurement.y - measurement.O * state.mean.tail<2>();
}

}  // namespace

bool UpdateExtended(const Linearized& measurement, ExtendedState& state, bool learns_size,
                    unsigned frozen) {
  if (!learns_size) frozen |= 1U << kLength | 1U << kWidth;
  if (!JosephUpdate<ExtendedState::kSize>(Innovation(measurement, state),
                                          WholeJacobian(measurement), measurement.R, state.mean,
                                          state.covariance, frozen)) {
    return false;
  }
  ClampExtended(state);
  return true;
}

std::optional<Likelihood> EvaluateExtended(const Linearized& measurement,
                                           const ExtendedState& state) {
  return EvaluateInnovation<ExtendedState::kSize>(
      Innovation(measurement, state), WholeJacobian(measurement), measurement.R, state.covariance);
}

bool UpdateExtended(const LinearizedPose& measurement, ExtendedState& state) {
  Eigen::Matrix<double, LinearizedPose::kRows, ExtendedState::kSize> H;
  H.setIdentity();
  if (!JosephUpdate<ExtendedState::kSize>(measurement.y, H, measurement.R, state.mean,
                                          state.covariance)) {
    return false;
  }
  ClampExtended(state);
  return true;
}

std::optional<Likelihood> EvaluateExtended(const LinearizedPose& measurement,
                                           const ExtendedState& state) {
  const LinearizedPose::Covariance S =
      state.covariance.topLeftCorner<LinearizedPose::kRows, LinearizedPose::kRows>() +
      measurement.R;
  return LikelihoodOf(measurement.y, S);
}

void UpdateExtent(double across_m, double across_sigma_m, double aspect_rad, Extent& extent) {
  const Eigen::Vector2d h(std::abs(std::sin(aspect_rad)), std::abs(std::cos(aspect_rad)));
  Eigen::Vector2d mean(extent.length_m, extent.width_m);
  Eigen::Vector2d variance(extent.length_sigma_m * extent.length_sigma_m,
                           extent.width_sigma_m * extent.width_sigma_m);
  const double S = h.cwiseAbs2().dot(variance) + across_sigma_m * across_sigma_m;
  if (!(S > 0.0) || !std::isfinite(across_m)) return;
  const Eigen::Vector2d gain = variance.cwiseProduct(h) / S;
  mean += gain * (across_m - h.dot(mean));
  // Length and width are kept apart: their correlation is given away, which is cautious.
  variance -= gain.cwiseProduct(h).cwiseProduct(variance);
  extent.length_m = std::clamp(mean[0], kMinSize_m, kMaxLength_m);
  extent.width_m = std::clamp(mean[1], kMinSize_m, kMaxWidth_m);
  extent.length_sigma_m = std::sqrt(std::max(variance[0], 0.0));
  extent.width_sigma_m = std::sqrt(std::max(variance[1], 0.0));
}

}  // namespace v2vouch
