// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/vehicle_terms.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/kalman.h"
#include "daemon/common/models/radar_outline.h"

namespace v2vouch {
namespace {

// The spread of a cluster speaks about the size only where it is not absurd.
constexpr double kSpanGate = 9.0;
// Beyond this squared distance a reflection beside the silhouette counts ever less.
constexpr double kEdgeGate = 4.0;
// From this squared distance on a box may be one of a vehicle of another size: one in twenty is, so
// much costs it. What so many boxes or clusters say counts more than a name.
constexpr double kOddBox = 9.0;
const double kOddSizeCost = 2.0 * std::log(20.0);
// Heading that a turn may gain on the filter, 1 sigma.
constexpr double kOddTurn_rad = 0.3;
// Clusters of a vehicle of which less is visible do not measure its size: what covers it may have
// given them a reflection.
constexpr double kSpanShare = 0.9;
// Seen at a smaller angle than this (its sine), a vehicle's length hides behind its near face:
// what a camera seems to say about it is its own lasting error.
constexpr double kLengthShows = 0.3;
// Where the returns put the near face, they put it so well.
constexpr double kFaceSigma_m = 0.4;

}  // namespace

double DepthOf(const Linearized& model, const ExtendedState& state) {
  if (model.O.rows() == 0) return 0.0;
  Eigen::Matrix<double, 1, ExtendedState::kSize> h;
  h << model.H.row(0), model.E.row(0), model.O.row(0);
  const double variance = h.lazyProduct(state.covariance).dot(h) + model.R(0, 0);
  return (model.y[0] - model.O.row(0).dot(state.mean.tail<2>())) / std::sqrt(variance);
}

std::optional<Linearized> Linearize(const ExtendedState& state, const Extent& extent,
                                    const RadarLook& look, const RadarMeasurement& z) {
  return LinearizeRadar(state.mean.head<kStateSize>(), extent, look.ego, look.radar, z);
}
std::optional<Linearized> Linearize(const ExtendedState& state, const Extent& extent,
                                    const CameraLook& look, const CameraMeasurement& z) {
  return LinearizeCamera(state.mean.head<kStateSize>(), extent, look.ego, look.camera, z);
}

void Temper(const RadarMeasurement& z, const ExtendedState& state, double usual_depth,
            Linearized& model) {
  if (z.is_object) return;
  TemperDepth(DepthOf(model, state) - usual_depth, model);
}

Extent AssumedExtent(const ExtendedState& state, const FilterSettings& settings) {
  return settings.point_targets ? Extent{0.0, 0.0, 0.0, 0.0} : state.assumed_extent();
}

unsigned Frozen(const ExtendedState& state, const Eigen::Vector2d& seen_from_O) {
  const Eigen::Vector2d line = (state.mean.head<2>() - seen_from_O).normalized();
  const double aspect = std::atan2(line.y(), line.x()) - state.mean[kYaw];
  return std::abs(std::sin(aspect)) < kLengthShows ? 1U << ExtendedState::kLength : 0U;
}

void Rename(ObjectClass from, ObjectClass to, const Eigen::Vector2d& seen_from_O,
            ExtendedState& state) {
  if (IsLong(to) && !IsLong(from)) {
    AssumeLongClass(to, seen_from_O, state);
  } else {
    AssumeClass(from, to, state);
  }
}

void KeepInside(const RadarLook& look, const RadarMeasurement& z, const FilterSettings& settings,
                ExtendedState& state) {
  if (settings.point_targets) return;
  auto edge = LinearizeEdges(state.mean.head<kStateSize>(), AssumedExtent(state, settings),
                             look.ego, look.radar, z);
  if (!edge) return;
  const auto fit = EvaluateExtended(*edge, state);
  if (!fit) return;
  // What lies far outside is another's, more likely.
  if (fit->distance_squared > kEdgeGate) edge->R *= fit->distance_squared / kEdgeGate;
  const unsigned frozen = 1U << kYaw | 1U << ExtendedState::kLength;
  static_cast<void>(UpdateExtended(*edge, state, false, frozen));
}

Span LearnSpan(const RadarLook& look, const RadarMeasurement& z, const FilterSettings& settings,
               ExtendedState& state) {
  if (settings.point_targets || z.visible_share < kSpanShare) return Span::kFits;
  const auto span = LinearizeSpan(state, look.ego, look.radar, z);
  if (!span) return Span::kFits;
  const auto likelihood = EvaluateExtended(*span, state);
  if (!likelihood || likelihood->distance_squared >= kSpanGate) {
    return span->y[0] > 0.0 ? Span::kTooDeep : Span::kTooWide;
  }
  ExtendedState grown = state;
  if (!UpdateExtended(*span, grown)) return Span::kFits;
  // A span bounds the length from below. Lorries show their far end last, so that it must not make
  // their length certain.
  grown.covariance = state.covariance;
  state = grown;
  return Span::kFits;
}

void FaceAt(double nearer_m, const Eigen::Vector2d& seen_from_O, ExtendedState& state) {
  const Eigen::Vector2d u = (state.mean.head<2>() - seen_from_O).normalized();
  const Eigen::Vector2d forward(std::cos(state.mean[kYaw]), std::sin(state.mean[kYaw]));
  const Eigen::Vector2d behind = forward.dot(u) > 0.0 ? forward : Eigen::Vector2d(-forward);
  state.mean.head<2>() -= nearer_m * u;
  // Along the line of sight what was known of the place is void; across it stays. The centre is
  // half a length behind the face: whatever the length turns out to be moves it.
  ExtendedState::Matrix T = ExtendedState::Matrix::Identity();
  T.topLeftCorner<2, 2>() -= u * u.transpose();
  T.block<2, 1>(0, ExtendedState::kLength) = 0.5 * std::abs(forward.dot(u)) * behind;
  ExtendedState::Matrix P = T.lazyProduct(state.covariance).lazyProduct(T.transpose());
  P.topLeftCorner<2, 2>() += kFaceSigma_m * kFaceSigma_m * u * u.transpose();
  state.covariance = 0.5 * (P + P.transpose());
}

bool IsWider(const CameraLook& look, const CameraMeasurement& z, const ExtendedState& state) {
  const Eigen::Vector2d line = state.mean.head<2>() - look.origin_O();
  const double aspect = std::atan2(line.y(), line.x()) - state.mean[kYaw];
  const double across_m = std::abs(std::sin(aspect)) * state.mean[ExtendedState::kLength] +
                          std::abs(std::cos(aspect)) * state.mean[ExtendedState::kWidth];
  return (z.azimuth_left_rad - z.azimuth_right_rad) * line.norm() > across_m;
}

std::optional<Likelihood> EvaluateOddSize(const CameraLook& look, const CameraMeasurement& z,
                                          const Likelihood& named, const ExtendedState& state) {
  if (!(named.distance_squared > kOddBox)) return std::nullopt;
  ExtendedState open = state;
  ReopenSize(IsWider(look, z, state), look.origin_O(), open);
  const auto model = Linearize(open, open.assumed_extent(), look, z);
  if (!model) return std::nullopt;
  auto likelihood = EvaluateExtended(*model, open);
  if (!likelihood) return std::nullopt;
  likelihood->log_det += kOddSizeCost;
  return CostOf(*likelihood) < CostOf(named) ? likelihood : std::nullopt;
}

ExtendedState Turned(const ExtendedState& state) {
  ExtendedState turned = state;
  turned.covariance(kYaw, kYaw) += kOddTurn_rad * kOddTurn_rad;
  return turned;
}
std::optional<Likelihood> EvaluateOddTurn(const Linearized& model, const ExtendedState& state) {
  if (std::abs(state.mean[kSpeed]) < kTurning_mps) return std::nullopt;
  auto likelihood = EvaluateExtended(model, Turned(state));
  if (likelihood) likelihood->log_det += kOddSizeCost;
  return likelihood;
}

}  // namespace v2vouch
