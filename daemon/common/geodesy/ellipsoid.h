// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch::wgs84 {

// WGS-84 defining parameters (NIMA TR8350.2, table 3.1).
inline constexpr double kA = 6378137.0;            ///< Semi-major axis [m].
inline constexpr double kF = 1.0 / 298.257223563;  ///< Flattening.
inline constexpr double kB = kA * (1.0 - kF);      ///< Semi-minor axis [m].
inline constexpr double kE2 = kF * (2.0 - kF);     ///< First eccentricity squared.
inline constexpr double kEp2 = kE2 / (1.0 - kE2);  ///< Second eccentricity squared.

}  // namespace v2vouch::wgs84
