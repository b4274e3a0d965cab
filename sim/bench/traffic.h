// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/bench/recording.h"

namespace v2vouch::bench {

/// Standard deviations of what a detection reports.
struct PoseNoise {
  double position_m = 0.5;  ///< Of each axis.
  double speed_mps = 0.5;
  double yaw_rad = 0.05;
  double yaw_rate_radps = 0.02;
};

/// Two-way traffic of constant density: the road's length follows from the number of vehicles.
struct TrafficSpec {
  int vehicles = 50;
  std::uint64_t seed = 1;
  int frames = 220;
  double period_s = 0.1;
  int lanes = 8;  ///< Half of them each way; 18 m/s on the right to 26 m/s on the left.
  double lane_width_m = 3.7;
  double spacing_m = 18.75;      ///< Mean distance of vehicles in a lane.
  double curvature_per_m = 0.0;  ///< Of the road's middle line; 0 = straight along +x.
  double heading_rad = 0.0;      ///< The whole scene is turned by this (Rotated).
  double detection_probability = 0.95;
  double clutter_share = 0.05;  ///< Mean false detections per frame, per vehicle.
  PoseNoise noise{};
};

/// Traffic with truth and detections. Speeds sway by up to 0.8 m/s with periods of 8 to 20 s.
/// Clutter is the hardest there is: anywhere on the road, with speed, direction and yaw rate of
/// traffic. Detections come in random order. Same spec, same recording.
Recording GenerateTraffic(const TrafficSpec& spec);

}  // namespace v2vouch::bench
