// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace v2vouch::view {

struct MapPoint {
  double x_m = 0.0;  ///< East in the world frame of TRUTH.
  double y_m = 0.0;  ///< North.
};

/// What a simulated drive says of its surroundings, for the picture only.
struct RoadMap {
  std::string name;
  std::vector<std::vector<MapPoint>> lanes;      ///< Lines that vehicles follow.
  std::vector<std::vector<MapPoint>> buildings;  ///< Outlines.

  [[nodiscard]] bool is_empty() const { return lanes.empty() && buildings.empty(); }
};

/// Reads the scenario that the simulator stored with its log (SIM_SCENARIO). What it cannot
/// understand is left out: a log may come from anywhere. At most 4096 points of each kind.
RoadMap ReadRoadMap(const std::string& scenario_yaml);

}  // namespace v2vouch::view
