// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/programs/spy/channel_table.h"
#include "daemon/rim/lcm_packets/packet_fault.h"

namespace v2vouch::spy {

/// What there is to tell at one moment.
struct Moment {
  const ChannelTable* table = nullptr;
  lcm_packets::PacketCounts packets{};  ///< Datagrams that became no message.
  std::int64_t kernel_drops = 0;
  std::int64_t damaged = 0;  ///< Stretches of a log.
  std::int64_t now_us = 0;   ///< Of arrival.
  bool is_log = false;       ///< Rates over everything, no ages.
};

/// Head line and one line per channel whose name holds `filter`; `is_narrow`: without type and
/// count of messages, for terminals of 80 columns.
std::vector<std::string> TableLines(const Moment& moment, const std::string& filter = "",
                                    bool is_narrow = false);
/// Refusals in words; empty where there are none.
std::vector<std::string> RefusalLines(const Moment& moment);
/// Everything, for programs.
std::string JsonOf(const Moment& moment);

}  // namespace v2vouch::spy
