// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "daemon/common/geodesy/wgs84.h"

namespace v2vouch {

/// A point in E [m]. A type of its own, so that it cannot be taken for a local one.
struct EcefPoint {
  Eigen::Vector3d p_E = Eigen::Vector3d::Zero();
};

/// A point of a local plane [m]: east, north, up, turned by the plane's gamma.
struct LocalPoint {
  Eigen::Vector3d p_L = Eigen::Vector3d::Zero();
};

/// WGS-84 to earth-centred coordinates, the paper's formulas:
///
///     X = (N + h) cos(phi) cos(lambda),  Y = (N + h) cos(phi) sin(lambda),
///     Z = (b^2/a^2 N + h) sin(phi),      N = a^2 / sqrt(a^2 cos^2(phi) + b^2 sin^2(phi))
EcefPoint ToEcef(const Wgs84& position);

/// The inverse, exact to double precision everywhere outside the earth's core (farther than
/// 50 km from the centre). On the axis the longitude is 0. Bowring (1976), iterated.
Wgs84 ToWgs84(const EcefPoint& point);

/// Distance of two points less its part along the vertical at `from_E`: what it is on the ground,
/// whatever the heights.
double HorizontalDistance(const Eigen::Vector3d& from_E, const Eigen::Vector3d& to_E);

/// R_EN: axes east, north, up at a position, as columns in E. At a pole, east and north are those
/// of the meridian that `longitude_rad` names.
Eigen::Matrix3d EastNorthUp(const Wgs84& position);

/// Local plane L: touches the ellipsoid's normal at `origin`; x axis points `gamma_rad`
/// counter-clockwise from east.
///
///     p_L = R_LE (p_E - origin_E),   R_LE = C_z(gamma) C_x(pi/2 - phi) C_z(pi/2 + lambda)
///
/// with C_i(t) the change of axes that are turned by t about axis i. The paper's R_x(phi)
/// R_y(lambda) R_z(gamma) names the same three angles; taken literally, it does not end in east,
/// north, up.
class LocalPlane {
 public:
  explicit LocalPlane(const Wgs84& origin, double gamma_rad = 0.0);

  [[nodiscard]] LocalPoint ToLocal(const EcefPoint& point) const;
  [[nodiscard]] LocalPoint ToLocal(const Wgs84& position) const {
    return ToLocal(ToEcef(position));
  }
  [[nodiscard]] EcefPoint ToEcefPoint(const LocalPoint& point) const;
  [[nodiscard]] Wgs84 ToGeodetic(const LocalPoint& point) const;
  /// R_LE: turns directions from E into L.
  [[nodiscard]] const Eigen::Matrix3d& R_LE() const { return R_LE_; }
  [[nodiscard]] const Wgs84& origin() const { return origin_; }
  [[nodiscard]] double gamma_rad() const { return gamma_rad_; }

 private:
  Wgs84 origin_;
  double gamma_rad_ = 0.0;
  Eigen::Vector3d origin_E_;
  Eigen::Matrix3d R_LE_;
};

}  // namespace v2vouch
