// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "daemon/common/data/sensor.h"

namespace v2vouch::evaluation {

/// What the evaluator has to know of one own sensor.
struct SensorSpec {
  std::string channel;  ///< RADAR_<NAME>, CAMERA_<NAME> or OBJECTS_<NAME>.
  SensorKind kind = SensorKind::kRadar;
  double x_m = 0.0;  ///< Place in the ego body frame, z above the road.
  double y_m = 0.0;
  double z_m = 0.0;
  double yaw_rad = 0.0;
  double half_fov_rad = 1.0;  ///< Covered azimuth is +- this.
  double max_range_m = 80.0;
  double period_s = 0.05;
  double range_sigma_m = 0.25;      ///< Radar: of one reflection, as the next two.
  double azimuth_sigma_rad = 0.01;  ///< Camera: of a box's middle.
  double range_rate_sigma_mps = 0.1;
  double depression_sigma_rad = 0.0037;  ///< Camera: bottom edge and body pitch together.
  double position_sigma_m = 0.3;         ///< Objects: of a box's centre, per axis.

  /// Whether a point, in the ego's body frame, is within range and field of view.
  [[nodiscard]] bool Covers(const Eigen::Vector2d& p_B) const;
};

/// Errors of the BSMs, as the scenario states them.
struct SenderSpec {
  double bias_sigma_m = 0.7;     ///< Constant part, per axis.
  double markov_sigma_m = 0.25;  ///< Gauss-Markov part, per axis.
  double markov_time_s = 30.0;
  double white_sigma_m = 0.05;  ///< Per axis.
  double speed_markov_mps = 0.05;
  double speed_white_mps = 0.05;
  double heading_markov_rad = 0.007;
  double heading_white_rad = 0.0035;
};

/// The scenario of a log as far as evaluation needs it, from the text on channel SIM_SCENARIO.
struct SceneSpecs {
  bool is_given = false;  ///< False: no usable text; the figures are the shipped vehicle's.
  std::string name;
  bool has_ideal_points = false;  ///< `sensors: mode: ideal_points`.
  double ego_length_m = 4.7;
  double ego_width_m = 1.85;
  double ego_centre_x_m = 1.4;
  std::vector<SensorSpec> sensors;
  SenderSpec sender;
  std::vector<std::vector<Eigen::Vector2d>> buildings;  ///< Outlines in the world frame.

  /// How many kinds of sensors must see a place before what is claimed there can be checked: two,
  /// or the one where boxes are all there is.
  [[nodiscard]] int KindsThatCheck() const;
};

/// Reads the effective scenario leniently: keys it does not know are passed over, missing ones
/// keep the defaults of data/vehicle.h. Text that is not YAML gives `is_given` = false.
SceneSpecs ReadSceneSpecs(const std::string& yaml);

}  // namespace v2vouch::evaluation
