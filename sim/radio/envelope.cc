// SPDX-License-Identifier: Apache-2.0
#include "sim/radio/envelope.h"

namespace v2vouch::sim {

std::vector<std::uint8_t> RadioPacket(std::span<const std::uint8_t> payload, int signal_dbm) {
  // Radiotap: version 0, 9 bytes, present: bit 5, signal in dBm.
  std::vector<std::uint8_t> packet = {0x00, 0x00, 9, 0x00, 0x20, 0x00, 0x00, 0x00};
  packet.push_back(static_cast<std::uint8_t>(signal_dbm & 0xFF));
  // QoS data, to all, from a made-up station, wildcard BSSID.
  packet.insert(packet.end(), {0x88, 0x00, 0x00, 0x00});
  packet.insert(packet.end(), 6, 0xFF);
  packet.insert(packet.end(), {0x02, 0x00, 0x56, 0x32, 0x56, 0x01});
  packet.insert(packet.end(), 6, 0xFF);
  packet.insert(packet.end(), 4, 0x00);
  packet.insert(packet.end(), {0xAA, 0xAA, 0x03, 0x00, 0x00, 0x00, 0x88, 0xDC});
  packet.insert(packet.end(), {0x03, 0x00, 0x20});
  if (payload.size() >= 0x80) {
    packet.push_back(static_cast<std::uint8_t>(0x80 | (payload.size() >> 8 & 0x3F)));
  }
  packet.push_back(static_cast<std::uint8_t>(payload.size() & 0xFF));
  packet.insert(packet.end(), payload.begin(), payload.end());
  return packet;
}

}  // namespace v2vouch::sim
