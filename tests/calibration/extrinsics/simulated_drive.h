// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "calibration/extrinsics/drive_log.h"
#include "sim/world/scenario.h"

namespace v2vouch {

/// A shipped scenario as the car's own sensors saw it, `change`d before it is driven.
DriveLog SimulatedDrive(const std::string& scenario, double duration_s, std::uint64_t seed,
                        const std::function<void(sim::Scenario&)>& change = {});

}  // namespace v2vouch
