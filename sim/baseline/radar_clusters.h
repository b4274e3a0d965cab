// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <v2vouch/radar_scan_t.hpp>
#include <vector>

#include "daemon/common/data/vehicle.h"

namespace v2vouch::baseline {

inline constexpr double kMoving_mps = 1.0;  ///< Above it a return or a track moves.

inline Eigen::Vector2d Direction(double yaw_rad) { return {std::cos(yaw_rad), std::sin(yaw_rad)}; }

/// The ego in the odometry frame, as dead reckoning has it.
struct EgoInOdometry {
  Eigen::Vector2d p_O;
  double yaw_O;
  double speed_mps;
  double yaw_rate_radps;
};

struct Cluster {
  Eigen::Vector2d face_O;    ///< Near face, odometry frame.
  Eigen::Vector2d sensor_O;  ///< Antenna.
  Eigen::Vector2d sensor_velocity_O;
  double rate_mps;  ///< Of the strongest return.
  bool is_moving;
  bool is_taken = false;
};
/// The returns of a scan in clusters, as BaselineTracker describes.
std::vector<Cluster> ClustersOf(const RadarConfig& radar, const radar_scan_t& scan,
                                const EgoInOdometry& ego);

}  // namespace v2vouch::baseline
