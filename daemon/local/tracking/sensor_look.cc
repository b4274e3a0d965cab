// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/sensor_look.h"

#include <cmath>

namespace v2vouch {
namespace {

// The middle of a box's bottom edge is this far from the middle of the vehicle's near face.
constexpr double kAcrossSigma_m = 0.2;
constexpr double kRadialSigma_m = 0.15;
// Of a bottom edge that the picture's end cuts off right before the car, the contact lies anywhere
// nearer, in shares of the distance there.
constexpr double kCutRange = 0.7;
constexpr double kCutSigma = 0.2;
constexpr double kBeyondCut = 2.0;

}  // namespace

RadarLook::RadarLook(const EgoState& ego_state, const RadarConfig& config)
    : ego(ego_state),
      radar(config),
      origin_O_((ego.X_OB * Point<Body>{radar.x_m, radar.y_m}).vector()) {}

CameraLook::CameraLook(const EgoState& ego_state, const CameraConfig& config)
    : ego(ego_state),
      camera(config),
      origin_O_((ego.X_OB * Point<Body>{camera.x_m, camera.y_m}).vector()) {}

Fix FixOf(const RadarLook& look, const RadarMeasurement& z) {
  const double bearing = z.azimuth_rad + look.radar.yaw_rad + look.ego.X_OB.yaw_rad();
  const Eigen::Vector2d line(std::cos(bearing), std::sin(bearing));
  const Eigen::Vector2d across(-line.y(), line.x());
  Eigen::Matrix2d G;  // d(position)/d(range, azimuth)
  G << line, z.range_m * across;
  return {look.origin_O() + z.range_m * line,
          G * z.covariance.topLeftCorner<2, 2>() * G.transpose()};
}

std::optional<Fix> FixOf(const CameraLook& look, const CameraMeasurement& z) {
  if (z.left_is_cut || z.right_is_cut) return std::nullopt;
  if (!(z.depression_rad > (z.bottom_is_cut ? kRightBefore_rad : 1e-3))) return std::nullopt;
  const double middle = 0.5 * (z.azimuth_left_rad + z.azimuth_right_rad);
  const double tangent = std::tan(z.depression_rad);
  // A bottom that the picture cuts off is nearer than where it is cut.
  const double most = look.camera.z_m / tangent;
  const double range = z.bottom_is_cut ? kCutRange * most : most;
  const double range_sigma = z.bottom_is_cut ? kCutSigma * most
                                             : look.camera.z_m * (1.0 + tangent * tangent) /
                                                   (tangent * tangent) * z.depression_sigma_rad;
  const double bearing = middle + look.camera.yaw_rad + look.ego.X_OB.yaw_rad();
  const Eigen::Vector2d line(std::cos(bearing), std::sin(bearing));
  const Eigen::Vector2d across(-line.y(), line.x());
  const double across_sigma = range * z.azimuth_sigma_rad + kAcrossSigma_m;
  const double along_sigma = range_sigma + kRadialSigma_m;
  return Fix{look.origin_O() + range * line,
             along_sigma * along_sigma * line * line.transpose() +
                 across_sigma * across_sigma * across * across.transpose()};
}

bool IsBeyondCut(const CameraLook& look, const CameraMeasurement& z, double range_m) {
  if (!z.bottom_is_cut || !(z.depression_rad > kRightBefore_rad)) return false;
  return range_m > kBeyondCut * look.camera.z_m / std::tan(z.depression_rad);
}

}  // namespace v2vouch
