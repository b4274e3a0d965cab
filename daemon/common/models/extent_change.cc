// SPDX-License-Identifier: Apache-2.0
// How the size of an ExtendedState is replaced by another, or found to be larger.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/extent.h"
#include "daemon/common/models/extent_limits.h"
#include "daemon/common/models/radar_outline.h"

namespace v2vouch {
namespace {

// Standard deviations of range or azimuth by which a span may exceed the box and the noise.
constexpr double kSpanSlack = 2.0;
// How well the deepest reflection marks the far end.
constexpr double kInsideSigma_m = 2.0;
// Seen at a smaller angle than this (its sine), a flank has next to no width in azimuth.
constexpr double kFlankShows = 0.3;
// How far the near face of a lorry may be from where a short vehicle's model had it.
constexpr double kFaceSigma_m = 1.5;
// Of any vehicle's size, 1 sigma.
constexpr double kAnyLengthSigma_m = 3.5;
constexpr double kAnyWidthSigma_m = 0.5;

constexpr int kLength = ExtendedState::kLength;
constexpr int kWidth = ExtendedState::kWidth;
using Vector = ExtendedState::Vector;
using Matrix = ExtendedState::Matrix;
// Of the difference that stands for a derivative.
constexpr double kStep_m = 0.1;

// The angle under which a box is seen from `sensor`, a place in the axes of the box from its
// centre. Near a long flank this is far from size / distance.
double AngularWidth(const Eigen::Vector2d& sensor, double length_m, double width_m) {
  const double middle = std::atan2(-sensor.y(), -sensor.x());
  double least = 0.0;
  double most = 0.0;
  for (const double x : {-0.5 * length_m, 0.5 * length_m}) {
    for (const double y : {-0.5 * width_m, 0.5 * width_m}) {
      const double off = AngleDifference(std::atan2(y - sensor.y(), x - sensor.x()), middle);
      least = std::min(least, off);
      most = std::max(most, off);
    }
  }
  return most - least;
}

}  // namespace

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
  ClampExtended(state);
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
  ClampExtended(state);
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
  ClampExtended(state);
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
  out.y.setZero(2);
  out.H.setZero(2, kStateSize);
  out.E.setZero(2, 2);
  const Eigen::Vector2d sensor = Eigen::Rotation2D<double>(-state.mean[kYaw]) * p_OS;
  const double length = state.mean[kLength];
  const double width = state.mean[kWidth];
  const double angle = AngularWidth(sensor, length, width);
  out.R.setZero(2, 2);
  const Eigen::Vector2d sigma(radar.range_sigma_m, radar.azimuth_sigma_rad);
  const Eigen::Vector2d span(measurement.radial_extent_m,
                             measurement.azimuth_max_rad - measurement.azimuth_min_rad);
  const Eigen::Vector2d whole(ca * length + sa * width, angle);
  bool says_something = false;
  for (int i = 0; i < 2; ++i) {
    // Noise alone spreads n returns over about 2 sigma sqrt(ln n), and what one scan shows too much
    // the next one shows again: vehicles must not grow by it.
    const double noise = 2.0 * std::sqrt(std::log(measurement.returns)) * sigma[i];
    const double excess = span[i] - noise - kSpanSlack * sigma[i] - whole[i];
    const double noise2 = noise * noise;
    const double inside = i == 0 ? kInsideSigma_m : kRadarEdgeSigma_m / range;
    out.R(i, i) = noise2 + inside * inside;
    if (!(excess > 0.0)) continue;
    out.y[i] = excess;
    says_something = true;
    if (i == 0) {
      out.E.row(0) << ca, sa;
      continue;
    }
    const double by_length = (AngularWidth(sensor, length + kStep_m, width) - angle) / kStep_m;
    const double by_width = (AngularWidth(sensor, length, width + kStep_m) - angle) / kStep_m;
    out.E.row(1) << (sa > kFlankShows ? by_length : 0.0), by_width;
  }
  if (!says_something) return std::nullopt;
  return out;
}

}  // namespace v2vouch
