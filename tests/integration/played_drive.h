// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/rim/io/lcm_bus.h"
#include "tests/support/wire_drive.h"

namespace v2vouch::testing {

/// The inputs of a drive behind one talking car, 30 m ahead at 9 m/s.
std::vector<WireMessage> DriveMessages(double duration_s);

/// Publishes them at their times.
void Play(LcmBus& bus, const std::vector<WireMessage>& messages);

/// Digest of the LOCAL lists that the same messages give without any process round them.
std::string DigestOf(const std::vector<WireMessage>& messages);

}  // namespace v2vouch::testing
