// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "sim/import/fcd.h"

namespace v2vouch::sim {

/// A vehicle's left turn and what it meets.
struct LeftTurn {
  std::size_t vehicle = 0;
  double middle_s = 0.0;  ///< When half of the turn is done.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double oncoming_s = 0.0;  ///< Vehicle-seconds of oncoming traffic within 80 m, 15 s either side.
};

/// The one left turn of a vehicle: turns by 60 to 135 degrees in all over its recorded way.
std::optional<LeftTurn> FindLeftTurn(const std::vector<std::vector<CentreSample>>& motions,
                                     std::size_t vehicle);

/// The left-turner that meets most oncoming traffic and is recorded at least 8 s before and 4 s
/// after the middle of its turn; ties go to the first. One whose footprint touches another's within
/// these 12 s is passed over (SUMO lets waiting turners stand in the way) unless all do.
std::optional<LeftTurn> BusiestLeftTurn(const std::vector<std::vector<CentreSample>>& motions,
                                        const std::vector<FcdBody>& bodies);

/// Rectangle with `yaw_rad` along its length.
struct CornerBuilding {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double length_m = 0.0;
  double width_m = 0.0;
};

/// A house in every corner between two neighbouring arms of the intersection round `centre`. Arms
/// are where traffic passes at 25 to 50 m. Each house keeps `setback_m` from every way that any
/// vehicle's centre takes.
std::vector<CornerBuilding> CornerBuildings(const Eigen::Vector2d& centre,
                                            const std::vector<std::vector<CentreSample>>& motions,
                                            double setback_m);

}  // namespace v2vouch::sim
