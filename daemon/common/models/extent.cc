// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/models/extent.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/kalman.h"
#include "daemon/common/models/radar_outline.h"

namespace v2vouch {
namespace {

constexpr double kMinSize_m = 0.3;
constexpr double kMaxLength_m = 25.0;
constexpr double kMaxWidth_m = 4.0;
// Standard deviations of range or azimuth by which a span may exceed the box and the noise.
constexpr double kSpanSlack = 2.0;
// How well the deepest reflection marks the far end.
constexpr double kInsideSigma_m = 2.0;
// Seen at a smaller angle than this (its sine), a flank has next to no width in azimuth.
constexpr double kFlankShows = 0.3;
// 2 cm after one second: nothing real, it keeps the filter able to change its mind.
constexpr double kSizePsd = 4e-4;

// How far the near face of a lorry may be from where a short vehicle's model had it.
constexpr double kFaceSigma_m = 1.5;
// Of any vehicle's size, 1 sigma.
constexpr double kAnyLengthSigma_m = 3.5;
constexpr double kAnyWidthSigma_m = 0.5;

constexpr int kLength = ExtendedState::kLength;
constexpr int kWidth = ExtendedState::kWidth;
constexpr int kDepth = ExtendedState::kDepth;
constexpr int kAside = ExtendedState::kAside;
constexpr int kOthers = ExtendedState::kSize - kStateSize;
// How long the offsets last: scatterers change with the aspect.
constexpr double kDepthDecay_s = 3.0;
constexpr double kAsideDecay_s = 5.0;
using Vector = ExtendedState::Vector;
using Matrix = ExtendedState::Matrix;

// First-order Gauss-Markov: x = phi x.
void Decay(int k, double sigma, double phi, ExtendedState& state) {
  state.mean[k] *= phi;
  state.covariance.row(k) *= phi;
  state.covariance.col(k) *= phi;
  state.covariance(k, k) += sigma * sigma * (1.0 - phi * phi);
}

void Clamp(ExtendedState& state) {
  double& length = state.mean[ExtendedState::kLength];
  double& width = state.mean[ExtendedState::kWidth];
  length = std::clamp(length, kMinSize_m, kMaxLength_m);
  width = std::clamp(width, kMinSize_m, kMaxWidth_m);
  state.mean[kYaw] = WrapAngle(state.mean[kYaw]);
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

void PredictExtended(ExtendedState& state, double dt_s, const MotionNoise& noise) {
  KinematicState motion = state.kinematic();
  StateMatrix F;
  PredictCtra(motion, dt_s, noise, &F);
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
  Clamp(state);
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
  Clamp(state);
  return true;
}

std::optional<Likelihood> EvaluateExtended(const LinearizedPose& measurement,
                                           const ExtendedState& state) {
  const LinearizedPose::Covariance S =
      state.covariance.topLeftCorner<LinearizedPose::kRows, LinearizedPose::kRows>() +
      measurement.R;
  return LikelihoodOf(measurement.y, S);
}

void AssumeClass(ObjectClass from, ObjectClass to, ExtendedState& state) {
  const Extent old_extent = ClassExtent(from);
  const Extent new_extent = ClassExtent(to);
  const Eigen::Vector2d old_mean(old_extent.length_m, old_extent.width_m);
  const Eigen::Vector2d old_sigma(old_extent.length_sigma_m, old_extent.width_sigma_m);
  const Eigen::Vector2d new_mean(new_extent.length_m, new_extent.width_m);
  const Eigen::Vector2d new_sigma(new_extent.length_sigma_m, new_extent.width_sigma_m);

  const Eigen::Matrix2d P = state.covariance.block<2, 2>(kLength, kLength);
  const Eigen::Vector2d mean = state.mean.segment<2>(kLength);
  Eigen::Vector2d size;
  Eigen::Matrix2d size_covariance = Eigen::Matrix2d::Zero();
  for (int i = 0; i < 2; ++i) {
    const double prior = 1.0 / (old_sigma[i] * old_sigma[i]);
    const double learned = std::max(0.0, 1.0 / P(i, i) - prior);  // Information from sensors.
    const double seen = learned * mean[i] + (learned > 0.0 ? prior * (mean[i] - old_mean[i]) : 0.0);
    const double fresh = 1.0 / (new_sigma[i] * new_sigma[i]);
    size_covariance(i, i) = 1.0 / (learned + fresh);
    size[i] = size_covariance(i, i) * (seen + fresh * new_mean[i]);
  }
  // The rest of the state given the size is as it was: regress on the old size, then put the new
  // distribution of the size in.
  Eigen::Matrix<double, ExtendedState::kSize, 2> G =
      state.covariance.middleCols<2>(kLength) * P.inverse();
  G.middleRows<2>(kLength).setIdentity();
  state.mean += G * (size - mean);
  state.mean.segment<2>(kLength) = size;
  Matrix covariance = state.covariance + G * (size_covariance - P) * G.transpose();
  state.covariance = 0.5 * (covariance + covariance.transpose());
  state.covariance.block<2, 2>(kLength, kLength) = size_covariance;
  Clamp(state);
}

namespace {

// Puts another size in, which grows away from the near face; the face stays, kFaceSigma_m
// uncertain.
void ReplaceSize(const Extent& size, const Eigen::Vector2d& seen_from_O, ExtendedState& state) {
  const Eigen::Vector2d forward(std::cos(state.mean[kYaw]), std::sin(state.mean[kYaw]));
  const double away = forward.dot(state.mean.head<2>() - seen_from_O) >= 0.0 ? 1.0 : -1.0;
  // Change of state per metre of length with the near face fixed.
  Vector growth = Vector::Zero();
  growth.head<2>() = 0.5 * away * forward;
  growth[kLength] = 1.0;
  // State of the near face: what is left of it once the length is taken out.
  Matrix to_face = Matrix::Identity();
  to_face.col(kLength) -= growth;
  Matrix P = to_face * state.covariance * to_face.transpose();
  P.topLeftCorner<2, 2>() += kFaceSigma_m * kFaceSigma_m * forward * forward.transpose();
  P.row(kWidth).setZero();
  P.col(kWidth).setZero();
  P(kWidth, kWidth) = size.width_sigma_m * size.width_sigma_m;
  P += size.length_sigma_m * size.length_sigma_m * growth * growth.transpose();
  state.covariance = 0.5 * (P + P.transpose());
  state.mean += (size.length_m - state.mean[kLength]) * growth;
  state.mean[kWidth] = size.width_m;
  Clamp(state);
}

}  // namespace

void AssumeLongClass(ObjectClass to, const Eigen::Vector2d& seen_from_O, ExtendedState& state) {
  ReplaceSize(ClassExtent(to), seen_from_O, state);
}

void ReopenSize(bool is_larger, const Eigen::Vector2d& seen_from_O, ExtendedState& state) {
  Extent size = ClassExtent(ObjectClass::kUnknown);
  if (is_larger) {
    size.length_m = std::max(size.length_m, state.mean[kLength]);
    size.width_m = std::max(size.width_m, state.mean[kWidth]);
  }
  size.length_sigma_m = kAnyLengthSigma_m;
  size.width_sigma_m = kAnyWidthSigma_m;
  ReplaceSize(size, seen_from_O, state);
}

void Lengthen(double length_m, double sigma_m, const Eigen::Vector2d& seen_from_O,
              ExtendedState& state) {
  const double growth = length_m - state.mean[ExtendedState::kLength];
  if (!(growth > 0.0)) return;
  const Eigen::Vector2d forward(std::cos(state.mean[kYaw]), std::sin(state.mean[kYaw]));
  const double away = forward.dot(state.mean.head<2>() - seen_from_O) >= 0.0 ? 1.0 : -1.0;
  Vector direction = Vector::Zero();  // d(state)/d(length) with the near face fixed.
  direction.head<2>() = 0.5 * away * forward;
  direction[ExtendedState::kLength] = 1.0;
  state.mean += growth * direction;
  state.covariance += sigma_m * sigma_m * direction * direction.transpose();
  Clamp(state);
}

std::optional<Linearized> LinearizeSpan(const ExtendedState& state, const EgoState& ego,
                                        const RadarConfig& radar,
                                        const RadarMeasurement& measurement) {
  if (measurement.is_object || measurement.returns < 2) return std::nullopt;
  const Point<Odometry> antenna = ego.X_OB * Point<Body>{radar.x_m, radar.y_m};
  const Eigen::Vector2d p_OS = antenna.vector() - state.mean.head<2>();
  const double range = p_OS.norm();
  if (!(range > 1.0)) return std::nullopt;
  const double aspect = std::atan2(p_OS.y(), p_OS.x()) - state.mean[kYaw];
  const double ca = std::abs(std::cos(aspect));
  const double sa = std::abs(std::sin(aspect));

  Linearized out;
  out.y.resize(2);
  out.H.setZero(2, kStateSize);
  out.E.resize(2, 2);
  out.E.row(0) << ca, sa;
  out.E.row(1) << (sa > kFlankShows ? sa / range : 0.0), ca / range;
  out.R.setZero(2, 2);
  const Eigen::Vector2d sigma(radar.range_sigma_m, radar.azimuth_sigma_rad);
  const Eigen::Vector2d span(measurement.radial_extent_m,
                             measurement.azimuth_max_rad - measurement.azimuth_min_rad);
  const Eigen::Vector2d whole(ca * state.mean[kLength] + sa * state.mean[kWidth],
                              (sa * state.mean[kLength] + ca * state.mean[kWidth]) / range);
  bool says_something = false;
  for (int i = 0; i < 2; ++i) {
    // Noise alone spreads n returns over about 2 sigma sqrt(ln n), and what one scan shows too much
    // the next one shows again: vehicles must not grow by it.
    const double noise = 2.0 * std::sqrt(std::log(measurement.returns)) * sigma[i];
    const double excess = span[i] - noise - kSpanSlack * sigma[i] - whole[i];
    const double noise2 = noise * noise;
    const double inside = i == 0 ? kInsideSigma_m : kRadarEdgeSigma_m / range;
    out.R(i, i) = noise2 + inside * inside;
    if (excess > 0.0) {
      out.y[i] = excess;
      says_something = true;
    } else {
      out.y[i] = 0.0;
      out.E.row(i).setZero();
    }
  }
  if (!says_something) return std::nullopt;
  return out;
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
