// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sim/world/world.h"

namespace v2vouch::sim {

/// An ego that stands at the origin, looks east and has its rear axle at (0, 0).
Scenario StandingEgo();

/// Adds a vehicle that stands (speed 0) or drives straight on from (x, y) in direction `yaw_rad`.
void AddVehicle(Scenario& scenario, std::uint32_t id, double x_m, double y_m, double yaw_rad,
                double speed_mps = 0.0, ObjectClass object_class = ObjectClass::kCar);

std::unique_ptr<World> MakeWorld(const Scenario& scenario, std::uint64_t seed = 1);

}  // namespace v2vouch::sim
