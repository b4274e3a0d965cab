// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include "daemon/common/data/ego.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// One of the reflections that mark a vehicle's outline, in the radar's frame R.
struct OutlineReturn {
  double range_m = 0.0;
  double azimuth_rad = 0.0;
  double strength_db = 0.0;  ///< SNR, or what stands for it; comparable within one scan.
};

/// One radar cluster (or one object of a radar that tracks by itself), in the radar's frame R.
struct RadarMeasurement {
  int radar = 0;         ///< Index into VehicleConfig::radars.
  int returns = 1;       ///< Reflections in the cluster.
  double range_m = 0.0;  ///< Of the cluster's reference point, see local/radar.
  double azimuth_rad = 0.0;
  double range_rate_mps = 0.0;  ///< As measured, relative to the moving antenna.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< Of [range, azimuth, range rate].
  double ground_range_rate_mps = 0.0;  ///< With the antenna's own motion taken out; 0 = stationary.
  bool is_static = false;              ///< ground_range_rate is explained by a stationary object.
  double near_range_m = 0.0;           ///< Of the nearest reflection.
  double radial_extent_m = 0.0;        ///< Farthest minus nearest range in the cluster.
  double azimuth_min_rad = 0.0;        ///< Right edge.
  double azimuth_max_rad = 0.0;        ///< Left edge.
  double middle_azimuth_rad = 0.0;     ///< Mean azimuth of all reflections, weak ones included.
  /// The strong reflections, nearest to the radar at their bearing, strongest first: they lie on
  /// the outline, weak ones anywhere inside of it. None from a sensor that tracks by itself.
  static constexpr std::size_t kMostOutline = 8;
  std::array<OutlineReturn, kMostOutline> outline{};
  std::size_t outline_count = 0;
  int object_id = -1;      ///< The sensor's own object id; -1 = none.
  bool is_object = false;  ///< From a sensor that tracks by itself (RadarOutput::kObjects).
  /// Share of the vehicle that this frame could observe, by azimuth; set once a track is given it.
  /// The rest lies past the field of view or is occluded.
  double visible_share = 1.0;
  bool may_be_anothers = false;  ///< Lies in the box of another tracked vehicle.
};

/// One camera box as angles in the levelled camera frame: origin at the optical centre, x along
/// the camera's yaw, y left, z up; roll, pitch and distortion taken out.
struct CameraMeasurement {
  int camera = 0;                     ///< Index into VehicleConfig::cameras.
  double azimuth_left_rad = 0.0;      ///< Bearing of the left edge, left positive.
  double azimuth_right_rad = 0.0;     ///< Bearing of the right edge.
  double depression_rad = 0.0;        ///< Of the bottom edge below the horizon, down positive.
  double azimuth_sigma_rad = 0.0;     ///< Of each edge.
  double depression_sigma_rad = 0.0;  ///< Picture noise and pitch together.
  /// The left edge is the picture's border, or (once a track is given it) where something else
  /// begins to cover the vehicle: no bearing of the object.
  bool left_is_cut = false;
  bool right_is_cut = false;
  bool bottom_is_cut = false;  ///< Depression says nothing.
  /// Of the top edge below the horizon; NaN where the picture's border cuts it off.
  double top_depression_rad = std::numeric_limits<double>::quiet_NaN();
  ObjectClass object_class = ObjectClass::kUnknown;
  double score = 0.0;
};

/// The whole motion of one vehicle as a box detector on lidar, a sensor that tracks by itself, or a
/// simulation reports it, in O and over ground: the first rows of the kinematic state (StateIndex).
struct PoseMeasurement {
  double x_m = 0.0;  ///< Of the footprint's centre.
  double y_m = 0.0;
  double yaw_rad = 0.0;    ///< Direction; any multiple of 2 pi may be added.
  double speed_mps = 0.0;  ///< Along it, negative in reverse.
  double yaw_rate_radps = 0.0;
  /// Of [x, y, yaw, speed, yaw rate]; symmetric and positive definite.
  Eigen::Matrix<double, 5, 5> covariance = Eigen::Matrix<double, 5, 5>::Identity();
};

/// One vehicle as a detector of boxes sees it (lidar network, smart camera, another fusion), in O.
/// It knows position, axis and size; where it knows no velocity, that is the tracker's to learn.
struct BoxMeasurement {
  double x_m = 0.0;  ///< Of the footprint's centre.
  double y_m = 0.0;
  double yaw_rad = 0.0;  ///< Of the axis; front and rear may be confused, but for has_front.
  double length_m = 4.0;
  double width_m = 1.7;
  double yaw_sigma_rad = 0.15;
  double length_sigma_m = 0.4;
  double width_sigma_m = 0.15;
  /// What the detector's score says: ln p(score | vehicle) / p(score | clutter); 0: nothing.
  double log_odds = 0.0;
  double score = 0.0;
  /// Share of the vehicle that this frame could observe; as in RadarMeasurement.
  double visible_share = 1.0;
  int sensor = 0;          ///< Index into VehicleConfig::objects.
  bool has_front = false;  ///< The detector knows the vehicle's ends apart.
  ObjectClass object_class = ObjectClass::kUnknown;
  Eigen::Matrix2d position_covariance = Eigen::Matrix2d::Identity();  ///< [m^2], in O.
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Identity();  ///< [m^2/s^2], in O.
  std::optional<Eigen::Vector2d> velocity_O_mps{};                    ///< Over ground.
};

using SensorMeasurement = std::variant<RadarMeasurement, CameraMeasurement, BoxMeasurement>;

/// A measurement that a LOCAL track was given, kept so that its PRIORITY filter can use it too.
struct SensorUpdate {
  std::uint64_t track_id = 0;
  SensorMeasurement measurement;
};

}  // namespace v2vouch
