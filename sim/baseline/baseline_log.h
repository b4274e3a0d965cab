// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "daemon/common/data/vehicle.h"

namespace v2vouch::baseline {

/// Runs the baseline over the log `in` and writes its TRUTH, SIM_SCENARIO and own TRACKS_LOCAL, 20
/// a second, to `out`. Without a scenario in the log the vehicle itself is written as
/// V2VOUCH_CONFIG, so that evaluation knows the sensors.
/// @return damaged stretches of `in`, which were skipped; nullopt with `error` set when a file
/// cannot be read or written.
std::optional<std::int64_t> RunBaseline(const std::string& in, const VehicleConfig& vehicle,
                                        const std::string& vehicle_yaml, const std::string& out,
                                        std::string& error);

}  // namespace v2vouch::baseline
