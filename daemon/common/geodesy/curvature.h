// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// What a radian of latitude and one of longitude are worth on the ground [m]: small moves without
/// a plane. Source: radii of curvature of the WGS-84 ellipsoid,
///
///     w = 1 - e^2 sin^2(phi),   meridian = a (1 - e^2) / w^1.5,   parallel = a cos(phi) / w^0.5
struct CurvatureRadii {
  double meridian_m;
  double parallel_m;  ///< Of the circle of latitude; at the poles that of a latitude 6 m away.
};
CurvatureRadii RadiiAt(double latitude_rad);

}  // namespace v2vouch
