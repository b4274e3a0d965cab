// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/import/fcd.h"

namespace v2vouch::sim {

struct SumoOptions {
  std::string name = "sumo";  ///< Of the scenario.
  std::string ego = "auto";   ///< SUMO id, or auto: the left-turner that meets most traffic.
  double v2v_share = 0.5;     ///< Of the vehicles; drawn by v2vouch-sim with its own seed.
  double van_share = 0.15;    ///< Of the cars, made tall vans of 5.4 m: they hide others.
  bool has_buildings = true;  ///< Houses in the corners of the intersection.
  double setback_m = 7.0;     ///< From the ways of vehicles' centres to the houses.
  double before_s = 20.0;     ///< Cut this long before the middle of the ego's turn ...
  double after_s = 15.0;      ///< ... and this long after.
  std::uint64_t seed = 1;     ///< Draws the vans.
};

/// A scenario for v2vouch-sim: the text of its YAML file and of the trajectories beside it, and
/// what was chosen.
struct SumoScenario {
  std::string yaml;
  std::string trajectories_csv;
  std::string ego;
  double duration_s = 0.0;
  std::size_t vehicles = 0;  ///< Besides the ego.
  std::size_t buildings = 0;
};

/// World frame: net frame shifted to the middle of the ego's turn (its middle of the cut where it
/// does not turn left).
/// @return false with `error` set: no such ego, no left-turner, too short.
bool MakeSumoScenario(const std::vector<FcdVehicle>& vehicles, const SumoOptions& options,
                      SumoScenario& scenario, std::string& error);

}  // namespace v2vouch::sim
