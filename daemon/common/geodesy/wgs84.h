// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// Geodetic position on WGS-84.
struct Wgs84 {
  double latitude_rad = 0.0;   ///< North positive, [-pi/2, pi/2].
  double longitude_rad = 0.0;  ///< East positive, (-pi, pi].
  double height_m = 0.0;       ///< Above the ellipsoid.
  friend bool operator==(const Wgs84&, const Wgs84&) = default;
};

}  // namespace v2vouch
