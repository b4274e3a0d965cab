// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace v2vouch::sim {

/// `payload` (IEEE 1609.2 or a bare MessageFrame) as a captured radio packet: radiotap with the
/// signal, 802.11 outside the context of a BSS, LLC, WSMP of IEEE 1609.3 with PSID 0x20.
std::vector<std::uint8_t> RadioPacket(std::span<const std::uint8_t> payload, int signal_dbm);

}  // namespace v2vouch::sim
