// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/alignment/flat_earth.h"

#include <cmath>

namespace v2vouch {

Eigen::Vector2d Flat(const LocalPlane& plane, const Wgs84& position) {
  const Wgs84 level{position.latitude_rad, position.longitude_rad, plane.origin().height_m};
  return plane.ToLocal(level).p_L.head<2>();
}

Wgs84 Unflat(const LocalPlane& plane, const Eigen::Vector2d& p_L) {
  LocalPoint point{{p_L.x(), p_L.y(), 0.0}};
  Wgs84 place = plane.ToGeodetic(point);
  // The ground falls away from the plane by d^2 / 2R: 2 m at 5 km. Each round leaves less than a
  // thousandth of the error.
  for (int round = 0; round < 3; ++round) {
    point.p_L.z() -= place.height_m - plane.origin().height_m;
    place = plane.ToGeodetic(point);
  }
  return place;
}

double ConvergenceAt(const LocalPlane& plane, const Wgs84& position) {
  const Eigen::Vector3d east_L = plane.R_LE() * EastNorthUp(position).col(0);
  return std::atan2(east_L.y(), east_L.x());
}

}  // namespace v2vouch
