// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/data/track.h"
#include "daemon/local/tracking/point_filter.h"
#include "daemon/local/tracking/sensor_look.h"
#include "daemon/local/tracking/vehicle_filter.h"

namespace v2vouch {

/// Filter of one vehicle. It lives in two stages:
///
/// 1. *point* (PointFilter): position and velocity of the reflecting point, while nothing is known
///    about the direction. A crossing vehicle would have its heading wrong by 90 degrees in any
///    model that needs one. While it is passed, the middle of its picture slides over the body,
///    and what never showed a radar any Doppler does not move, whatever its velocity seems to be.
/// 2. *vehicle* (VehicleFilter): CTRA with size, from the moment the velocity points somewhere
///    (heading sigma below 0.15 rad) or is known to be none on. A vehicle that stops keeps its yaw.
class TrackFilter {
 public:
  static TrackFilter FromRadar(const RadarLook& look, const RadarMeasurement& measurement,
                               const FilterSettings& settings);
  static TrackFilter FromCamera(const CameraLook& look, const CameraMeasurement& measurement,
                                const Fix& fix);

  /// A vehicle at once.
  static TrackFilter FromPose(const PoseMeasurement& measurement);
  static TrackFilter FromBox(const BoxMeasurement& measurement);

  /// Where the sensor of the next box stands, in O: the near face is the one that it sees.
  void SeenFrom(const Eigen::Vector2d& origin_O) { seen_from_ = origin_O; }

  /// A track that only cameras have seen learns its range from a standing return in its direction.
  void TakeStanding(const Fix& fix);

  void Predict(double dt_s, const FilterSettings& settings);

  /// The squared distance is that of the best component, the density that of the whole mixture.
  template <class Look, class Measurement>
  [[nodiscard]] std::optional<Likelihood> Evaluate(const Look& look, const Measurement& z,
                                                   const FilterSettings& settings) const;
  [[nodiscard]] std::optional<Likelihood> Evaluate(const PoseMeasurement& measurement,
                                                   const FilterSettings& settings) const;
  [[nodiscard]] std::optional<Likelihood> Evaluate(const BoxMeasurement& measurement,
                                                   const FilterSettings& settings) const;
  /// @return false on numerical failure; the track must be dropped.
  template <class Look, class Measurement>
  bool Update(const Look& look, const Measurement& z, const FilterSettings& settings);

  /// A point, and a vehicle whose direction is in doubt, becomes the vehicle that the pose
  /// describes: a reflection that may lie anywhere on it knows nothing of the centre that the pose
  /// does not know better.
  bool Update(const PoseMeasurement& measurement);
  /// The same for a box, of which a point or a vehicle whose direction is in doubt keeps the
  /// velocity.
  bool Update(const BoxMeasurement& measurement);

  /// Which way a vehicle that was never seen driving most likely faces.
  void FaceTowards(double yaw_rad) { vehicle_.FaceTowards(yaw_rad); }

  /// Takes the class's typical size for dimensions without a measurement.
  void SetClass(ObjectClass object_class);

  /// A part of it was found this far behind its near face (Lengthen of models/extent.h); a point
  /// has no length yet.
  void Lengthen(double length_m, double sigma_m);

  /// State and size as the rest of the program sees them. A point's centre lies behind it by what
  /// its likely direction says; without one, it is taken to stand as the ego does, and the speed is
  /// as uncertain as the velocity is in any direction.
  void Show(const FilterSettings& settings, LocalTrack& track) const;

  [[nodiscard]] bool is_vehicle() const { return is_vehicle_; }
  /// Its front and axis are those of its motion.
  [[nodiscard]] bool has_driven() const { return is_vehicle_ && vehicle_.has_driven(); }
  [[nodiscard]] bool knows_direction() const;  ///< Front and axis; whole poses need both.
  [[nodiscard]] bool may_move_face() const { return is_vehicle_ && vehicle_.may_move_face(); }
  [[nodiscard]] Eigen::Vector2d seen_from_O() const { return seen_from_; }
  [[nodiscard]] Eigen::Vector2d position_O() const;
  [[nodiscard]] Eigen::Vector2d velocity_O() const;
  [[nodiscard]] Eigen::Matrix2d position_covariance() const;

 private:
  enum class Doppler { kUnseen, kNone, kMoving };  // What radars have shown of it so far.

  void Note(const RadarMeasurement& z);
  void Note(const CameraMeasurement&) { has_pictures_ = true; }
  bool StandStill(const RadarLook& look, const RadarMeasurement& z);
  bool StandStill(const CameraLook&, const CameraMeasurement&) { return true; }
  [[nodiscard]] bool HasDirection(const PointFilter& point, double max_sigma_rad,
                                  double most_share) const;
  void PromoteIfClear(const FilterSettings& settings);
  [[nodiscard]] PointFilter SlidingPoint(const FilterSettings& settings) const;
  [[nodiscard]] ExtendedState ShowPoint(const FilterSettings& settings) const;
  [[nodiscard]] double LastingVariance(const ExtendedState& state) const;

  bool is_vehicle_ = false;
  bool is_measured_whole_ = false;  // By a pose or a box.
  Doppler doppler_ = Doppler::kUnseen;
  bool has_pictures_ = false;
  bool moves_in_pictures_ = false;  // A vehicle whose motion no radar has confirmed.
  double age_s_ = 0.0;
  PointFilter point_;  // Until it is a vehicle.
  VehicleFilter vehicle_;
  Eigen::Vector2d seen_from_ = Eigen::Vector2d::Zero();     // Last sensor that saw it, in O.
  Eigen::Vector2d ego_velocity_ = Eigen::Vector2d::Zero();  // Of the ego then, in O.
  double default_yaw_rad_ = 0.0;
  ObjectClass object_class_ = ObjectClass::kUnknown;
};

}  // namespace v2vouch
