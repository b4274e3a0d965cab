// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "daemon/common/data/input.h"

namespace v2vouch::sim {

/// One row of SUMO's floating car data. Positions are the front bumper's centre in the net frame
/// (x east, y north).
struct FcdSample {
  double time_s = 0.0;
  Eigen::Vector2d front = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;  ///< Counter-clockwise from east.
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

struct FcdVehicle {
  std::string id;                  ///< SUMO's.
  std::string type;                ///< SUMO's vehicle type.
  std::vector<FcdSample> samples;  ///< In order of time, no gap above 1 s.
};

/// Reads a table with the columns time_s, id, type, lon_deg, lat_deg, x_m, y_m,
/// heading_deg_cw_from_north, speed_mps, plain or gzip-compressed. A vehicle that vanishes for more
/// than a second or jumps (SUMO "teleports" what is stuck) counts as a new one from there on.
/// @return in order of first appearance; empty with `error` set on a fault.
std::vector<FcdVehicle> ReadFcd(const std::string& path, std::string& error);

struct FcdBody {
  ObjectClass object_class = ObjectClass::kCar;
  double length_m = 4.3;
  double width_m = 1.8;
};

/// Class and size by the name of the type; SUMO's own defaults per class. Unknown names are cars.
FcdBody BodyOfType(const std::string& type);

/// Where the centre of the footprint is, and how the body points and moves.
struct CentreSample {
  double time_s = 0.0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;  ///< Continuous, not wrapped.
  double speed_mps = 0.0;
};

/// Turns a bumper that follows lane centres (SUMO) into a body that could drive it: sideways jumps
/// of lane changes are spread over 20 m, positions smoothed by a local straight line over +-1.2 s,
/// and the rear axle is towed behind the bumper, which gives yaw without steps.
std::vector<CentreSample> CentreMotion(const FcdVehicle& vehicle, const FcdBody& body);

}  // namespace v2vouch::sim
