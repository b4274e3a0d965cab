// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/vehicle_filter.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/kalman.h"
#include "daemon/local/tracking/vehicle_terms.h"

namespace v2vouch {
namespace {

// What so many boxes or clusters say counts more than a name.
constexpr int kLargerBoxes = 3;    // In a row: a vehicle that shows its whole flank,
constexpr int kSmallerBoxes = 12;  // and one that is partly hidden, or badly boxed.
constexpr int kOddSpans = 3;
// A cluster that is too wide may hold a part of the vehicle beside, which radars do not tell apart
// well: such clusters must come more often than every fourth time. One that is too deep holds no
// vehicle behind, which would be covered.
constexpr int kOddSpanWeight = 3;
// Memory of how deep the returns lie, per scan, and the most that one scan adds to it.
constexpr double kDepthMemory = 0.1;
constexpr double kMostDepth = 6.0;
// Strong returns lie on the near face: where they lie before it, or behind, scan after scan, by so
// many standard deviations and metres, they say where it is.
constexpr double kOffSigmas = 2.0;
constexpr double kOff_m = 0.7;
// Of what is partly hidden the near face may be what cannot be seen, and returns before it may be
// those of what stands there: visible shares that are asked for.
constexpr double kWhole = 0.9;
constexpr double kHalf = 0.5;
// Behind the face of a longer vehicle they may come from anywhere under it, and those of one that
// stands are the same in scan after scan, another's among them.
constexpr double kShallow_m = 7.0;

// Share of its likelihood that a measurement has in the choice of the axis. A stationary vehicle
// shows a radar the same reflections in scan after scan: as evidence for an axis they would count
// again and again, always for the axis that allows them the least scatter. The errors of its boxes
// last, too: with a share of 1 a few cut or covered boxes settled cars of a parked row across the
// road.
constexpr double kPictureShare = 0.25;
double AxisShare(const RadarMeasurement& z) { return z.is_static ? 0.0 : 1.0; }
double AxisShare(const CameraMeasurement&) { return kPictureShare; }

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

}  // namespace

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
    const auto odd_turn = EvaluateOddTurn(*model, best());
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
void VehicleFilter::NoteDepth(const RadarMeasurement& z, const Linearized& model) {
  if (z.is_object || model.O.rows() == 0) return;
  const double depth = std::clamp(DepthOf(model, best()), -kMostDepth, kMostDepth);
  usual_depth_ += kDepthMemory * (depth - usual_depth_);
}

// One more scan takes the memory of the depth to kOffSigmas at the earliest from here.
bool VehicleFilter::may_move_face() const {
  return (1.0 - kDepthMemory) * std::abs(usual_depth_) + kDepthMemory * kMostDepth >= kOffSigmas;
}

bool VehicleFilter::IsOffFace(const RadarMeasurement& z, const Linearized& model) const {
  if (z.is_object || z.may_be_anothers || model.O.rows() == 0) return false;
  const double deeper_m = model.y[0];
  if (usual_depth_ < -kOffSigmas) {
    return z.visible_share >= (z.is_static ? kWhole : kHalf) && deeper_m < -kOff_m;
  }
  const bool is_car_in_motion = has_driven_ && std::abs(best().mean[kSpeed]) > kTurning_mps &&
                                best().mean[ExtendedState::kLength] < kShallow_m;
  return is_car_in_motion && z.visible_share >= kWhole && usual_depth_ > kOffSigmas &&
         deeper_m > kOff_m;
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
