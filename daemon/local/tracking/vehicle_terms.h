// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <type_traits>

#include "daemon/common/models/extent.h"
#include "daemon/local/tracking/sensor_look.h"
#include "daemon/local/tracking/vehicle_filter.h"

// Private to the vehicle filter's files: what one measurement says of one component.
namespace v2vouch {

template <class Measurement>
inline constexpr bool kLearnsSize = std::is_same_v<Measurement, CameraMeasurement>;
/// Slower than this a vehicle hardly turns.
inline constexpr double kTurning_mps = 1.0;

/// How far behind the expected outline the returns lie, in standard deviations.
double DepthOf(const Linearized& model, const ExtendedState& state);

std::optional<Linearized> Linearize(const ExtendedState& state, const Extent& extent,
                                    const RadarLook& look, const RadarMeasurement& z);
std::optional<Linearized> Linearize(const ExtendedState& state, const Extent& extent,
                                    const CameraLook& look, const CameraMeasurement& z);

/// Returns much deeper, or nearer, than they usually are count less.
void Temper(const RadarMeasurement& z, const ExtendedState& state, double usual_depth,
            Linearized& model);
inline void Temper(const CameraMeasurement&, const ExtendedState&, double, Linearized&) {}

Extent AssumedExtent(const ExtendedState& state, const FilterSettings& settings);

/// States that a measurement may not change, as bits.
unsigned Frozen(const ExtendedState& state, const Eigen::Vector2d& seen_from_O);

void Rename(ObjectClass from, ObjectClass to, const Eigen::Vector2d& seen_from_O,
            ExtendedState& state);

/// Reflections beside the silhouette move it.
void KeepInside(const RadarLook& look, const RadarMeasurement& z, const FilterSettings& settings,
                ExtendedState& state);
inline void KeepInside(const CameraLook&, const CameraMeasurement&, const FilterSettings&,
                       ExtendedState&) {}

enum class Span { kFits, kTooWide, kTooDeep };
/// What the spread of the cluster says about the size.
Span LearnSpan(const RadarLook& look, const RadarMeasurement& z, const FilterSettings& settings,
               ExtendedState& state);
inline Span LearnSpan(const CameraLook&, const CameraMeasurement&, const FilterSettings&,
                      ExtendedState&) {
  return Span::kFits;
}

/// Puts the near face where the returns are, `nearer_m` before where it was thought to be. Its
/// other end is as far behind as the length says, and as little known.
void FaceAt(double nearer_m, const Eigen::Vector2d& seen_from_O, ExtendedState& state);

/// Whether a box is wider than this vehicle would show itself.
bool IsWider(const CameraLook& look, const CameraMeasurement& z, const ExtendedState& state);
inline bool IsWider(const RadarLook&, const RadarMeasurement&, const ExtendedState&) {
  return true;
}

inline double CostOf(const Likelihood& likelihood) {
  return likelihood.distance_squared + likelihood.log_det;
}
/// The box as that of a vehicle of this motion and any size, where that explains it better.
std::optional<Likelihood> EvaluateOddSize(const CameraLook& look, const CameraMeasurement& z,
                                          const Likelihood& named, const ExtendedState& state);
/// A moving vehicle whose box is odd may have turned more than its returns told: the same, as
/// likely as a wrong size, with a heading that is open.
ExtendedState Turned(const ExtendedState& state);
/// @param model of the box at `state`, whose mean no turn changes.
std::optional<Likelihood> EvaluateOddTurn(const Linearized& model, const ExtendedState& state);

}  // namespace v2vouch
