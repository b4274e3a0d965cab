// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/vehicle_filter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/kalman.h"
#include "daemon/common/models/radar_outline.h"
#include "daemon/local/tracking/initial_sigmas.h"

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
// Slower than this a vehicle hardly turns.
constexpr double kTurning_mps = 1.0;
constexpr int kLargerBoxes = 3;    // In a row: a vehicle that shows its whole flank,
constexpr int kSmallerBoxes = 12;  // and one that is partly hidden, or badly boxed.
constexpr int kOddSpans = 3;
// Heading that a turn may gain on the filter, 1 sigma.
constexpr double kOddTurn_rad = 0.3;
// A cluster that is too wide may hold a part of the vehicle beside, which radars do not tell apart
// well: such clusters must come more often than every fourth time. One that is too deep holds no
// vehicle behind, which would be covered.
constexpr int kOddSpanWeight = 3;
// Clusters of a vehicle of which less is visible do not measure its size: what covers it may have
// given them a reflection.
constexpr double kSpanShare = 0.9;
// Seen at a smaller angle than this (its sine), a vehicle's length hides behind its near face:
// what a camera seems to say about it is its own lasting error.
constexpr double kLengthShows = 0.3;
// Memory of how deep the returns lie, per scan, and the most that one scan adds to it.
constexpr double kDepthMemory = 0.1;
constexpr double kMostDepth = 6.0;
// Strong returns lie on the near face: where they lie before it, or behind, scan after scan, by so
// many standard deviations and metres, they say where it is.
constexpr double kOffSigmas = 2.0;
constexpr double kOff_m = 0.7;
// Behind the face of a longer vehicle they may come from anywhere under it.
constexpr double kShallow_m = 7.0;
constexpr double kFaceSigma_m = 0.4;
// Axes of a standing vehicle: most stand along the road or across it.
constexpr std::array<double, VehicleFilter::kMostAxes> kAxisWeight = {0.4, 0.3, 0.15, 0.15};
constexpr std::array<double, VehicleFilter::kMostAxes> kAxisTurn_rad = {0.0, kPi / 2, kPi / 4,
                                                                        -kPi / 4};
constexpr double kAxisSigma_rad = 0.25;
constexpr double kLeastWeight = 0.005;
constexpr double kSameAxis_rad = 0.1;
// Across the road either end may be the front.
constexpr double kSurelyTurned_rad = 0.6;
// Driving forwards or backwards is no longer in doubt.
constexpr double kDriving_mps = 1.0;
constexpr double kDrivingSigmas = 3.0;

template <class Measurement>
constexpr bool kLearnsSize = std::is_same_v<Measurement, CameraMeasurement>;

// How far behind the expected outline the returns lie, in standard deviations.
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

// Returns much deeper, or nearer, than they usually are count less.
void Temper(const RadarMeasurement&, const ExtendedState& state, double usual_depth,
            Linearized& model) {
  TemperDepth(DepthOf(model, state) - usual_depth, model);
}
void Temper(const CameraMeasurement&, const ExtendedState&, double, Linearized&) {}

Extent AssumedExtent(const ExtendedState& state, const FilterSettings& settings) {
  return settings.point_targets ? Extent{0.0, 0.0, 0.0, 0.0} : state.assumed_extent();
}

// Share of its likelihood that a measurement has in the choice of the axis. A stationary vehicle
// shows a radar the same reflections in scan after scan: as evidence for an axis they would count
// again and again, always for the axis that allows them the least scatter. The errors of its boxes
// last, too: with a share of 1 a few cut or covered boxes settled cars of a parked row across the
// road.
constexpr double kPictureShare = 0.25;
double AxisShare(const RadarMeasurement& z) { return z.is_static ? 0.0 : 1.0; }
double AxisShare(const CameraMeasurement&) { return kPictureShare; }

// States that a measurement may not change, as bits.
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

// `model`: of the measurement at `state`.
template <class Look, class Measurement>
bool UpdateState(const Look& look, const Measurement& z, const Linearized& model, bool is_young,
                 bool knows_axis, double usual_depth, const FilterSettings& settings,
                 ExtendedState& state) {
  ExtendedState next = state;
  unsigned frozen = Frozen(state, look.origin_O());
  // What stands does not turn: where its reflections lie says less of its axis than it seems to.
  if ((!kLearnsSize<Measurement> || knows_axis) && std::abs(state.mean[kSpeed]) < kTurning_mps) {
    frozen |= 1U << kYaw;
  }
  if (!UpdateExtended(model, next, kLearnsSize<Measurement>, frozen)) return false;
  if (is_young) {
    // Iterated EKF, one more round: linearise where the first update went, then apply the result to
    // the prediction.
    auto again = Linearize(next, AssumedExtent(next, settings), look, z);
    if (again) {
      Temper(z, next, usual_depth, *again);
      ExtendedState::Vector back = state.mean - next.mean;
      back[kYaw] = WrapAngle(back[kYaw]);
      again->y -= again->H * back.head<kStateSize>() + again->E * back.segment<2>(kStateSize);
      ExtendedState iterated = state;
      if (UpdateExtended(*again, iterated, kLearnsSize<Measurement>, frozen)) next = iterated;
    }
  }
  state = next;
  return true;
}

// Reflections beside the silhouette move it.
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
void KeepInside(const CameraLook&, const CameraMeasurement&, const FilterSettings&,
                ExtendedState&) {}

enum class Span { kFits, kTooWide, kTooDeep };

// What the spread of the cluster says about the size.
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
Span LearnSpan(const CameraLook&, const CameraMeasurement&, const FilterSettings&, ExtendedState&) {
  return Span::kFits;
}

// Puts the near face where the returns are, `nearer_m` before where it was thought to be. Its other
// end is as far behind as the length says, and as little known.
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

// Whether a box is wider than this vehicle would show itself.
bool IsWider(const CameraLook& look, const CameraMeasurement& z, const ExtendedState& state) {
  const Eigen::Vector2d line = state.mean.head<2>() - look.origin_O();
  const double aspect = std::atan2(line.y(), line.x()) - state.mean[kYaw];
  const double across_m = std::abs(std::sin(aspect)) * state.mean[ExtendedState::kLength] +
                          std::abs(std::cos(aspect)) * state.mean[ExtendedState::kWidth];
  return (z.azimuth_left_rad - z.azimuth_right_rad) * line.norm() > across_m;
}
bool IsWider(const RadarLook&, const RadarMeasurement&, const ExtendedState&) { return true; }

double CostOf(const Likelihood& likelihood) {
  return likelihood.distance_squared + likelihood.log_det;
}

// The box as that of a vehicle of this motion and any size, where that explains it better.
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

// A moving vehicle whose box is odd may have turned more than its returns told: the same, as likely
// as a wrong size, with a heading that is open.
ExtendedState Turned(const ExtendedState& state) {
  ExtendedState turned = state;
  turned.covariance(kYaw, kYaw) += kOddTurn_rad * kOddTurn_rad;
  return turned;
}
std::optional<Likelihood> EvaluateOddTurn(const CameraLook& look, const CameraMeasurement& z,
                                          const ExtendedState& state) {
  if (std::abs(state.mean[kSpeed]) < kTurning_mps) return std::nullopt;
  const ExtendedState turned = Turned(state);
  const auto model = Linearize(turned, turned.assumed_extent(), look, z);
  if (!model) return std::nullopt;
  auto likelihood = EvaluateExtended(*model, turned);
  if (likelihood) likelihood->log_det += kOddSizeCost;
  return likelihood;
}

}  // namespace

// Centre = point - offset of the reflections, with the derivatives that tie the centre to direction
// and size.
ExtendedState VehicleAt(const PointFilter& point, double yaw_rad, double yaw_sigma_rad,
                        const Extent& size, const Eigen::Vector2d& seen_from_O,
                        const FilterSettings& settings) {
  const bool has_direction = yaw_sigma_rad == 0.0;
  const Eigen::Vector2d v = point.velocity();
  const double yaw = has_direction ? std::atan2(v.y(), v.x()) : yaw_rad;
  const Eigen::Vector2d forward(std::cos(yaw), std::sin(yaw));
  const Eigen::Vector2d p_SQ = point.position() - seen_from_O;

  // Offset in axes of O, with the sensor seen from the point instead of from the centre: both lie
  // on nearly the same line. The distance is stretched by half a width, where the centre is.
  const double range = std::max(p_SQ.norm(), 0.5);
  const auto offset_O = [&](const Eigen::Vector2d& ahead, const Extent& extent) -> Eigen::Vector2d {
    if (settings.point_targets) return Eigen::Vector2d::Zero();
    const Eigen::Vector2d p_OS = -p_SQ * (1.0 + 0.5 * extent.width_m / range);
    Eigen::Matrix2d R_OT;
    R_OT << ahead.x(), -ahead.y(), ahead.y(), ahead.x();
    return R_OT * ReflectionOffset(p_OS, ahead, extent);
  };
  ExtendedState out;
  const Eigen::Vector2d offset = offset_O(forward, size);
  const Eigen::Vector2d centre = point.position() - offset;
  const double speed = has_direction ? v.norm() : v.dot(forward);
  out.mean << centre, yaw, speed, 0.0, 0.0, size.length_m, size.width_m, 0.0, 0.0;

  // Inputs: point, velocity, yaw (where only assumed), length, width.
  Eigen::Matrix<double, ExtendedState::kSize, 7> J =
      Eigen::Matrix<double, ExtendedState::kSize, 7>::Zero();
  const double h = 1e-4;
  const auto turned = [yaw](double by) {
    return Eigen::Vector2d(std::cos(yaw + by), std::sin(yaw + by));
  };
  const Eigen::Vector2d by_yaw =
      (offset_O(turned(h), size) - offset_O(turned(-h), size)) / (2.0 * h);
  Extent longer = size, wider = size;
  longer.length_m += h;
  wider.width_m += h;
  J.topLeftCorner<2, 2>().setIdentity();
  J.block<2, 1>(0, 5) = -(offset_O(forward, longer) - offset) / h;
  J.block<2, 1>(0, 6) = -(offset_O(forward, wider) - offset) / h;
  J.block<1, 2>(kSpeed, 2) = forward.transpose();
  J(ExtendedState::kLength, 5) = 1.0;
  J(ExtendedState::kWidth, 6) = 1.0;
  Eigen::Matrix<double, 7, 7> P = Eigen::Matrix<double, 7, 7>::Zero();
  P.topLeftCorner<4, 4>() = point.covariance();
  if (has_direction) {
    const Eigen::RowVector2d yaw_by_v =
        Eigen::RowVector2d(-v.y(), v.x()) / std::max(v.squaredNorm(), 1e-6);
    J.block<1, 2>(kYaw, 2) = yaw_by_v;
    J.block<2, 2>(0, 2) = -by_yaw * yaw_by_v;
  } else {
    J(kYaw, 4) = 1.0;
    J.block<2, 1>(0, 4) = -by_yaw;
    P(4, 4) = yaw_sigma_rad * yaw_sigma_rad;
  }
  P(5, 5) = size.length_sigma_m * size.length_sigma_m;
  P(6, 6) = size.width_sigma_m * size.width_sigma_m;
  const Eigen::Matrix<double, ExtendedState::kSize, 7> JP = J.lazyProduct(P);
  out.covariance = JP.lazyProduct(J.transpose());
  out.covariance(kYawRate, kYawRate) = kInitialYawRateSigma_radps * kInitialYawRateSigma_radps;
  out.covariance(kAccel, kAccel) = kInitialAccelSigma_mps2 * kInitialAccelSigma_mps2;
  AssumeOffsets(out);
  return out;
}

void FaceAbout(ExtendedState& state) {
  state.mean[kYaw] = WrapAngle(state.mean[kYaw] + kPi);
  for (const int k : {static_cast<int>(kSpeed), static_cast<int>(kAccel)}) {
    state.mean[k] = -state.mean[k];
    state.covariance.row(k) *= -1.0;
    state.covariance.col(k) *= -1.0;
  }
}

VehicleFilter& VehicleFilter::operator=(const VehicleFilter& other) {
  std::copy_n(other.components_.begin(), other.count_, components_.begin());
  count_ = other.count_;
  has_driven_ = other.has_driven_;
  is_size_open_ = other.is_size_open_;
  odd_boxes_ = other.odd_boxes_;
  odd_spans_ = other.odd_spans_;
  is_deep_ = other.is_deep_;
  usual_depth_ = other.usual_depth_;
  return *this;
}

void VehicleFilter::StartMoving(const PointFilter& point, const Extent& size,
                                const Eigen::Vector2d& seen_from_O,
                                const FilterSettings& settings) {
  components_[0] = {VehicleAt(point, 0.0, 0.0, size, seen_from_O, settings), 1.0};
  count_ = 1;
  has_driven_ = true;
}

void VehicleFilter::StartStanding(const PointFilter& point, double likely_yaw_rad,
                                  const Extent& size, const Eigen::Vector2d& seen_from_O,
                                  const FilterSettings& settings) {
  count_ = kMostAxes;
  for (std::size_t i = 0; i < kMostAxes; ++i) {
    const double yaw = WrapAngle(likely_yaw_rad + kAxisTurn_rad[i]);
    components_[i] = {VehicleAt(point, yaw, kAxisSigma_rad, size, seen_from_O, settings),
                      kAxisWeight[i]};
  }
  has_driven_ = false;
}

void VehicleFilter::Predict(double dt_s, const FilterSettings& settings) {
  for (std::size_t i = 0; i < count_; ++i) {
    PredictExtended(components_[i].state, dt_s, settings.motion);
  }
}

template <class Look, class Measurement>
std::optional<Likelihood> VehicleFilter::Evaluate(const Look& look, const Measurement& z,
                                                  ObjectClass object_class,
                                                  const FilterSettings& settings) const {
  std::optional<Likelihood> best;
  double least = 0.0;  // Of distance + log determinant - 2 ln weight.
  double sum = 0.0;    // Of the components' likelihoods, relative to the best one's.
  for (std::size_t i = 0; i < count_; ++i) {
    const ExtendedState* state = &components_[i].state;
    ExtendedState named;
    // A radar track is measured against what the box says it is: an 11 m lorry's silhouette is no
    // outlier of a car's.
    if constexpr (kLearnsSize<Measurement>) {
      if (object_class == ObjectClass::kUnknown && z.object_class != ObjectClass::kUnknown &&
          !is_size_open_) {
        named = *state;
        Rename(object_class, z.object_class, look.origin_O(), named);
        state = &named;
      }
    }
    auto model = Linearize(*state, AssumedExtent(*state, settings), look, z);
    if (!model) continue;
    Temper(z, *state, usual_depth_, *model);
    auto likelihood = EvaluateExtended(*model, *state);
    if (!likelihood) continue;
    if constexpr (kLearnsSize<Measurement>) {
      if (!settings.point_targets) {
        if (const auto odd = EvaluateOddSize(look, z, *likelihood, *state)) likelihood = odd;
      }
    }
    const double cost =
        likelihood->distance_squared + likelihood->log_det - 2.0 * std::log(components_[i].weight);
    if (!best || cost < least) {
      sum = best ? sum * std::exp(0.5 * (cost - least)) + 1.0 : 1.0;
      least = cost;
      best = likelihood;
    } else {
      sum += std::exp(0.5 * (least - cost));
    }
  }
  if (best) best->log_det = least - best->distance_squared - 2.0 * std::log(sum);
  return best;
}

// What the likeliest component takes the measurement for.
template <class Look, class Measurement>
VehicleFilter::Box VehicleFilter::Judge(const Look& look, const Measurement& z,
                                        const FilterSettings& settings) const {
  if constexpr (kLearnsSize<Measurement>) {
    if (settings.point_targets) return Box::kFits;
    const auto model = Linearize(best(), AssumedExtent(best(), settings), look, z);
    const auto named = model ? EvaluateExtended(*model, best()) : std::nullopt;
    if (!named) return Box::kFits;
    const auto odd_size = EvaluateOddSize(look, z, *named, best());
    if (!odd_size) return Box::kFits;
    const auto odd_turn = EvaluateOddTurn(look, z, best());
    return odd_turn && CostOf(*odd_turn) < CostOf(*odd_size) ? Box::kTurned : Box::kOtherSize;
  } else {
    return Box::kFits;
  }
}

void VehicleFilter::Reopen(bool is_larger, const Eigen::Vector2d& seen_from_O) {
  for (std::size_t i = 0; i < count_; ++i) {
    ReopenSize(is_larger, seen_from_O, components_[i].state);
  }
  is_size_open_ = true;
  odd_boxes_ = odd_spans_ = 0;
  is_deep_ = false;
}

template <class Look, class Measurement>
bool VehicleFilter::Update(const Look& look, const Measurement& z, bool is_young,
                           const FilterSettings& settings) {
  const Box box = Judge(look, z, settings);
  if (box == Box::kTurned) {
    for (std::size_t i = 0; i < count_; ++i) components_[i].state = Turned(components_[i].state);
  }
  if (box == Box::kOtherSize) {
    // One such box may show two vehicles as one.
    const bool is_larger = IsWider(look, z, best());
    if (++odd_boxes_ < (is_larger ? kLargerBoxes : kSmallerBoxes)) return true;
    Reopen(is_larger, look.origin_O());
  } else if (kLearnsSize<Measurement>) {
    odd_boxes_ = 0;
  }
  const double axis_share = count_ > 1 ? AxisShare(z) : 0.0;
  std::array<double, kMostAxes> fit{};
  std::size_t kept = 0;
  Span best_fit = Span::kTooDeep;
  bool is_refit = false;
  for (std::size_t i = 0; i < count_; ++i) {
    Component& component = components_[i];
    auto model = Linearize(component.state, AssumedExtent(component.state, settings), look, z);
    if (!model) continue;
    if (i == 0) NoteDepth(z, *model);
    if (IsOffFace(z, *model)) {
      FaceAt(-model->y[0], look.origin_O(), component.state);
      model = Linearize(component.state, AssumedExtent(component.state, settings), look, z);
      if (!model) continue;
      is_refit = true;
    }
    Temper(z, component.state, usual_depth_, *model);
    double log_likelihood = 0.0;
    if (axis_share > 0.0) {
      const auto likelihood = EvaluateExtended(*model, component.state);
      if (!likelihood) continue;
      log_likelihood = -0.5 * axis_share * CostOf(*likelihood);
    }
    if (!UpdateState(look, z, *model, is_young, has_driven_, usual_depth_, settings,
                     component.state)) {
      continue;
    }
    KeepInside(look, z, settings, component.state);
    best_fit = std::min(best_fit, LearnSpan(look, z, settings, component.state));
    fit[kept] = log_likelihood;
    if (kept != i) components_[kept] = component;
    ++kept;
  }
  if (kept == 0) return false;
  count_ = kept;
  if (is_refit) usual_depth_ = 0.0;
  if (best_fit != Span::kFits) {
    odd_spans_ += kOddSpanWeight;
  } else if (!is_deep_) {
    odd_spans_ = std::max(0, odd_spans_ - 1);
  }
  is_deep_ = is_deep_ || best_fit == Span::kTooDeep;
  if (odd_spans_ >= kOddSpans * kOddSpanWeight) Reopen(true, look.origin_O());
  if (axis_share > 0.0 && count_ > 1) Weigh(std::span(fit).first(count_));
  TurnRound();
  return true;
}

// Where scan after scan lies deep (or near), it is the filter that is off. `model`: of the
// likeliest component.
void VehicleFilter::NoteDepth(const RadarMeasurement&, const Linearized& model) {
  if (model.O.rows() == 0) return;
  const double depth = std::clamp(DepthOf(model, best()), -kMostDepth, kMostDepth);
  usual_depth_ += kDepthMemory * (depth - usual_depth_);
}

// One more scan takes the memory of the depth to kNearerSigmas at the earliest from here.
bool VehicleFilter::may_move_face() const {
  return (1.0 - kDepthMemory) * std::abs(usual_depth_) + kDepthMemory * kMostDepth >= kOffSigmas;
}

bool VehicleFilter::IsOffFace(const RadarMeasurement& z, const Linearized& model) const {
  return !z.may_be_anothers && model.O.rows() > 0 && std::abs(usual_depth_) > kOffSigmas &&
         std::abs(model.y[0]) > kOff_m && (usual_depth_ > 0.0) == (model.y[0] > 0.0) &&
         (usual_depth_ < 0.0 || (has_driven_ && best().mean[ExtendedState::kLength] < kShallow_m));
}

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
  if (has_driven_) return;
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

template std::optional<Likelihood> VehicleFilter::Evaluate(const RadarLook&,
                                                           const RadarMeasurement&, ObjectClass,
                                                           const FilterSettings&) const;
template std::optional<Likelihood> VehicleFilter::Evaluate(const CameraLook&,
                                                           const CameraMeasurement&, ObjectClass,
                                                           const FilterSettings&) const;
template bool VehicleFilter::Update(const RadarLook&, const RadarMeasurement&, bool,
                                    const FilterSettings&);
template bool VehicleFilter::Update(const CameraLook&, const CameraMeasurement&, bool,
                                    const FilterSettings&);

}  // namespace v2vouch
