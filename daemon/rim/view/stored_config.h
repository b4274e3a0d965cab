// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "daemon/common/data/vehicle.h"
#include "daemon/rim/wire/channels.h"

namespace v2vouch::view {

/// What a picture needs of the configuration that the daemon stored with a log (V2VOUCH_CONFIG).
struct StoredConfig {
  VehicleConfig vehicle;
  wire::ChannelNames channels;
};

/// Reads it; another version's may have other keys, and what is known is taken.
StoredConfig ReadStoredConfig(std::string_view text);

}  // namespace v2vouch::view
