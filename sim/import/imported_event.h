// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/common/base/time.h"

namespace v2vouch::sim {

/// One encoded message and when it reached the recorder.
struct ImportedEvent {
  Timestamp received{};
  std::string channel;
  std::vector<std::uint8_t> bytes;
};

}  // namespace v2vouch::sim
