// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/data/ego.h"
#include "daemon/data/measurement.h"
#include "daemon/data/track.h"
#include "daemon/data/vehicle.h"
#include "daemon/models/ctra.h"
#include "daemon/models/extent.h"
#include "daemon/models/measurement_model.h"

namespace v2vouch {

/// One radar or camera together with the ego's state at the moment it looked.
struct RadarLook {
  const EgoState& ego;
  const RadarConfig& radar;
  [[nodiscard]] Eigen::Vector2d origin_O() const;
};
struct CameraLook {
  const EgoState& ego;
  const CameraConfig& camera;
  [[nodiscard]] Eigen::Vector2d origin_O() const;
};

/// Where a measurement alone puts the reflecting point, with its covariance, in O [m].
struct Fix {
  Eigen::Vector2d p_O = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
};
Fix FixOf(const RadarLook& look, const RadarMeasurement& measurement);
/// nullopt where the box has no usable bottom edge or bearing, or lies on the horizon.
std::optional<Fix> FixOf(const CameraLook& look, const CameraMeasurement& measurement);

/// What the filter has to know beside the measurement.
struct FilterSettings {
  MotionNoise motion;
  bool point_targets = false;  ///< Detections are of the centre: no extent model.
};

/// Filter of one vehicle. It lives in two stages:
///
/// 1. *point*: position and velocity of the reflecting point, constant velocity, while the
/// direction
///    of travel is unknown. One look gives the radial velocity only; a crossing vehicle would have
///    its heading wrong by 90 degrees in any model that needs one.
/// 2. *vehicle*: CTRA with size (ExtendedState), from the moment the velocity points somewhere
///    (heading sigma below 0.25 rad) on. There is no way back: a vehicle that stops keeps its yaw.
class TrackFilter {
 public:
  static TrackFilter FromRadar(const RadarLook& look, const RadarMeasurement& measurement,
                               const FilterSettings& settings);
  static TrackFilter FromCamera(const CameraLook& look, const CameraMeasurement& measurement,
                                const Fix& fix);

  void Predict(double dt_s, const FilterSettings& settings);

  [[nodiscard]] std::optional<Likelihood> Evaluate(const RadarLook& look,
                                                   const RadarMeasurement& measurement,
                                                   const FilterSettings& settings) const;
  [[nodiscard]] std::optional<Likelihood> Evaluate(const CameraLook& look,
                                                   const CameraMeasurement& measurement,
                                                   const FilterSettings& settings) const;
  /// @return false on numerical failure; the track must be dropped.
  bool Update(const RadarLook& look, const RadarMeasurement& measurement,
              const FilterSettings& settings);
  bool Update(const CameraLook& look, const CameraMeasurement& measurement,
              const FilterSettings& settings);

  /// Takes the class's typical size for what nobody measured yet.
  void SetClass(ObjectClass object_class);

  /// A part of it was found this far behind its near face (Lengthen of models/extent.h); a point
  /// has no length yet.
  void Lengthen(double length_m, double sigma_m);

  /// State and size as the rest of the program sees them. A point's centre lies behind it by what
  /// its likely direction says; without one, it is taken to stand as the ego does.
  void Show(const FilterSettings& settings, LocalTrack& track) const;

  [[nodiscard]] bool is_vehicle() const { return is_vehicle_; }
  [[nodiscard]] Eigen::Vector2d seen_from_O() const { return seen_from_; }
  [[nodiscard]] Eigen::Vector2d position_O() const;
  [[nodiscard]] Eigen::Vector2d velocity_O() const;
  [[nodiscard]] Eigen::Matrix2d position_covariance() const;

 private:
  template <class Look, class Measurement>
  bool UpdateVehicle(const Look& look, const Measurement& measurement,
                     const FilterSettings& settings);
  [[nodiscard]] bool HasDirection(double max_sigma_rad) const;
  [[nodiscard]] ExtendedState AsVehicle(bool has_direction, const FilterSettings& settings) const;
  void PromoteIfDirected(const FilterSettings& settings);

  bool is_vehicle_ = false;
  double age_s_ = 0.0;
  ExtendedState vehicle_;
  Eigen::Vector4d point_ = Eigen::Vector4d::Zero();  // x, y, vx, vy in O.
  Eigen::Matrix4d point_covariance_ = Eigen::Matrix4d::Identity();
  Eigen::Vector2d seen_from_ = Eigen::Vector2d::Zero();  // Last sensor that saw it, in O.
  double default_yaw_rad_ = 0.0;
  ObjectClass object_class_ = ObjectClass::kUnknown;
};

}  // namespace v2vouch
