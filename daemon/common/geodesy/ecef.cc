// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/geodesy/ecef.h"

#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/geodesy/ellipsoid.h"

namespace v2vouch {
namespace {

using wgs84::kA;
using wgs84::kB;
using wgs84::kE2;
using wgs84::kEp2;
using wgs84::kF;

}  // namespace

EcefPoint ToEcef(const Wgs84& position) {
  const double sin_phi = std::sin(position.latitude_rad);
  const double cos_phi = std::cos(position.latitude_rad);
  const double h = position.height_m;
  const double N = kA * kA / std::sqrt(kA * kA * cos_phi * cos_phi + kB * kB * sin_phi * sin_phi);
  return {{(N + h) * cos_phi * std::cos(position.longitude_rad),
           (N + h) * cos_phi * std::sin(position.longitude_rad),
           (kB * kB / (kA * kA) * N + h) * sin_phi}};
}

Wgs84 ToWgs84(const EcefPoint& point) {
  const double X = point.p_E.x();
  const double Y = point.p_E.y();
  const double Z = point.p_E.z();
  const double p = std::hypot(X, Y);

  // Bowring's fixed point in the parametric latitude beta. One round is good to 1e-11 rad near the
  // ground; the few further rounds reach the last bit, also far above and below it. Sines and
  // cosines are carried instead of angles, so the poles need no special case.
  double sin_beta = kA * Z;
  double cos_beta = kB * p;
  double sin_phi = 0.0;
  double cos_phi = 1.0;
  for (int round = 0; round < 12; ++round) {
    const double beta_norm = std::hypot(sin_beta, cos_beta);
    if (beta_norm <= 0.0) break;  // The earth's centre: any latitude is right.
    sin_beta /= beta_norm;
    cos_beta /= beta_norm;
    const double up = Z + kEp2 * kB * sin_beta * sin_beta * sin_beta;
    const double out = p - kE2 * kA * cos_beta * cos_beta * cos_beta;
    const double phi_norm = std::hypot(up, out);
    if (phi_norm <= 0.0) break;
    const double change = std::abs(up / phi_norm - sin_phi) + std::abs(out / phi_norm - cos_phi);
    sin_phi = up / phi_norm;
    cos_phi = out / phi_norm;
    if (change < 1e-16) break;
    sin_beta = (1.0 - kF) * sin_phi;
    cos_beta = cos_phi;
  }
  // Well conditioned at every latitude, unlike p / cos(phi) - N.
  const double h = p * cos_phi + Z * sin_phi - kA * std::sqrt(1.0 - kE2 * sin_phi * sin_phi);
  return {std::atan2(sin_phi, cos_phi), p > 0.0 ? WrapAngle(std::atan2(Y, X)) : 0.0, h};
}

double HorizontalDistance(const Eigen::Vector3d& from_E, const Eigen::Vector3d& to_E) {
  // The normal of the ellipsoid at sea level below; off by at most the height's share of 3e-6 rad
  // per km, so there is no need to solve for the latitude.
  Eigen::Vector3d up(from_E.x(), from_E.y(), from_E.z() / (1.0 - kE2));
  const double norm = up.norm();
  if (norm <= 0.0) return (to_E - from_E).norm();
  up /= norm;
  const Eigen::Vector3d d = to_E - from_E;
  return (d - d.dot(up) * up).norm();
}

Eigen::Matrix3d EastNorthUp(const Wgs84& position) {
  const double sin_phi = std::sin(position.latitude_rad);
  const double cos_phi = std::cos(position.latitude_rad);
  const double sin_lambda = std::sin(position.longitude_rad);
  const double cos_lambda = std::cos(position.longitude_rad);
  Eigen::Matrix3d R_EN;
  R_EN << -sin_lambda, -sin_phi * cos_lambda, cos_phi * cos_lambda,  //
      cos_lambda, -sin_phi * sin_lambda, cos_phi * sin_lambda,       //
      0.0, cos_phi, sin_phi;
  return R_EN;
}

LocalPlane::LocalPlane(const Wgs84& origin, double gamma_rad)
    : origin_(origin), gamma_rad_(gamma_rad), origin_E_(ToEcef(origin).p_E) {
  const double c = std::cos(gamma_rad);
  const double s = std::sin(gamma_rad);
  Eigen::Matrix3d R_LN;  // Axes turned by gamma see directions turned by -gamma.
  R_LN << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  R_LE_ = R_LN * EastNorthUp(origin).transpose();
}

LocalPoint LocalPlane::ToLocal(const EcefPoint& point) const {
  return {R_LE_ * (point.p_E - origin_E_)};
}

EcefPoint LocalPlane::ToEcefPoint(const LocalPoint& point) const {
  return {origin_E_ + R_LE_.transpose() * point.p_L};
}

Wgs84 LocalPlane::ToGeodetic(const LocalPoint& point) const { return ToWgs84(ToEcefPoint(point)); }

}  // namespace v2vouch
