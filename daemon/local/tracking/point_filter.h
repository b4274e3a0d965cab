// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/models/measurement_model.h"
#include "daemon/local/tracking/sensor_look.h"

namespace v2vouch {

/// Position and velocity of a vehicle's reflecting point in O, constant velocity with white
/// acceleration: less of it, the surer it is that the point is slow. One frame gives the radial
/// velocity only, so a new track has no direction yet that a model of a vehicle could start from.
class PointFilter {
 public:
  /// @param is_exact the detections are of the vehicle's centre, free of the reflections' scatter.
  static PointFilter FromRadar(const RadarLook& look, const RadarMeasurement& z, bool is_exact);
  static PointFilter FromCamera(const Fix& fix);
  /// From a picture and a radar return in its direction that shows no Doppler: it stands, or moves
  /// across the line of sight.
  static PointFilter FromStanding(const Fix& fix, const Eigen::Vector2d& seen_from_O);

  void Predict(double dt_s);

  [[nodiscard]] std::optional<Likelihood> Evaluate(const RadarLook& look, const RadarMeasurement& z,
                                                   bool is_exact) const;
  [[nodiscard]] std::optional<Likelihood> Evaluate(const CameraLook& look,
                                                   const CameraMeasurement& z, bool is_exact) const;
  /// @return false on numerical failure; state untouched.
  bool Update(const RadarLook& look, const RadarMeasurement& z, bool is_exact);
  bool Update(const CameraLook& look, const CameraMeasurement& z, bool is_exact);

  /// The same with the velocity in doubt by this much in any direction, 1 sigma.
  [[nodiscard]] PointFilter Doubted(double sigma_mps) const;

  /// The velocity points somewhere: at least 1 m/s, known to `most_share` of itself along it, and
  /// across it to `max_sigma_rad` as an angle.
  [[nodiscard]] bool HasDirection(double max_sigma_rad, double most_share) const;
  /// It stands: slower than 1 m/s, and known to be, in every direction.
  [[nodiscard]] bool IsStanding() const;

  [[nodiscard]] Eigen::Vector2d position() const { return mean_.head<2>(); }
  [[nodiscard]] Eigen::Vector2d velocity() const { return mean_.tail<2>(); }
  /// Of x, y, vx, vy.
  [[nodiscard]] const Eigen::Matrix4d& covariance() const { return covariance_; }

 private:
  static PointFilter AtRest(const Fix& fix, const Eigen::Matrix2d& velocity_covariance);

  Eigen::Vector4d mean_ = Eigen::Vector4d::Zero();
  Eigen::Matrix4d covariance_ = Eigen::Matrix4d::Identity();
};

/// FixOf with the scatter of reflections over a vehicle of unknown direction.
Fix ReflectionFixOf(const RadarLook& look, const RadarMeasurement& z);

}  // namespace v2vouch
