// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/models/measurement_model.h"

namespace v2vouch {

/// What the outline model leaves to lasting offsets, per radar row; a filter that carries them as
/// states uses these figures as their stationary sigmas.
inline constexpr double kDepthOffsetSigma_m = 0.2;  ///< Of the outline behind the strong returns.
inline constexpr double kAsideOffsetSigma = 0.2;    ///< Of the middle, in half silhouettes.

/// LinearizeRadar for a cluster whose outline returns are known (RadarMeasurement::outline).
///
///     h(x) = [ mean over k of (range of the box's outline along the azimuth of return k) + depth,
///              middle of the box's silhouette, cut at the field of view,
///              range rate of the body at the mean outline return ]
///
/// Strong reflections lie on the near outline, weak ones anywhere inside: the range row uses the
/// strong ones only, each against the outline at its own bearing. Across the line of sight
/// a reflection may lie anywhere on the silhouette; the mean of all is its middle, known to 0.3 of
/// half of it at best, since scatterers stay where the body has them.
/// `offsets` of the result: d(range)/d(depth offset [m]), d(azimuth)/d(aside offset [half
/// silhouettes]).
/// @return nullopt when the antenna is inside of the box.
std::optional<Linearized> LinearizeOutline(const StateVector& x, const Extent& extent,
                                           const EgoState& ego, const RadarConfig& radar,
                                           const RadarMeasurement& measurement);

/// Every reflection lies inside of the silhouette: where the outermost one of a cluster sticks out
/// on one side, by more than noise does, the vehicle is farther to that side. One row, the bearing
/// of that edge. nullopt where none does, or on both sides.
std::optional<Linearized> LinearizeEdges(const StateVector& x, const Extent& extent,
                                         const EgoState& ego, const RadarConfig& radar,
                                         const RadarMeasurement& measurement);

/// Weighs the range row down where the returns lie deeper than expected by more than 1.5 standard
/// deviations (the outline may not have answered), or nearer by more than 3.
void TemperDepth(double sigmas, Linearized& outline);

}  // namespace v2vouch
