// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "daemon/common/data/object_class.h"
#include "sim/sensors/radar_view.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// Radar cross section of a vehicle's class in realistic mode [dBsm].
double UsualRcs(ObjectClass object_class);

/// Reflections of a vehicle in one scan, on average: 2 far away to 8 close by for a car.
double MeanReflections(ObjectClass object_class, double range_m);

struct Spot {
  Vec2 place;
  double weight;
};

/// Strong points of a vehicle on the sides that face the antenna.
std::vector<Spot> StrongSpots(const Box& box, const Vec2& antenna);

/// What stands beside the road and reflects.
struct Scenery {
  std::vector<Scatterer> scatterers;
  std::vector<std::pair<Vec2, Vec2>> mirrors;  ///< Pieces of rails and facades.
};
Scenery SceneryOf(const World& world);

}  // namespace v2vouch::sim
