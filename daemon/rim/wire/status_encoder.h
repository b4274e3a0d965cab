// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/rim/wire/status.h"

namespace v2vouch::wire {

/// The daemon's state -> bytes of V2VOUCH_STATUS, into `bytes`, whose storage is reused.
void EncodeStatus(const Status& status, std::vector<std::uint8_t>& bytes);

}  // namespace v2vouch::wire
