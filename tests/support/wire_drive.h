// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/common/data/input.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch::testing {

struct WireMessage {
  std::string channel;
  std::vector<std::uint8_t> bytes;
  Timestamp received{};
};

/// Inputs as they travel, on the default channels: what the decoders turn back into the same
/// inputs, BSMs to J2735's resolution. Received at their stamps. For sensors without flips and
/// offsets.
std::vector<WireMessage> EncodeInputs(const std::vector<Input>& inputs,
                                      const VehicleConfig& vehicle);

}  // namespace v2vouch::testing
