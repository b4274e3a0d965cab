// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/common/data/vehicle.h"
#include "sim/world/scenario.h"

namespace v2vouch::sim {

/// The ego car as it really is: the `vehicle` section with the `mounting` errors added to it.
/// Sensors that nobody knows (CheckMounting) are passed over.
VehicleConfig Mounted(const Scenario& scenario);

/// Whether every entry of `mounting` names a part of the car, and only what that part has.
void CheckMounting(const Scenario& scenario, std::vector<std::string>& problems);

}  // namespace v2vouch::sim
