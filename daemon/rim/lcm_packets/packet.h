// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "daemon/rim/lcm_packets/packet_fault.h"

namespace v2vouch::lcm_packets {

inline constexpr std::size_t kLongestChannel = 63;      ///< LCM's own limit.
inline constexpr std::size_t kLongestDatagram = 65507;  ///< What UDP over IPv4 carries.

/// One datagram, taken apart. The views lie in the datagram.
struct Packet {
  std::uint32_t sequence = 0;
  bool is_fragment = false;  ///< Of several, even where there is but one.
  bool has_channel = false;  ///< A whole message, or the first fragment.
  std::string_view channel;
  std::span<const std::uint8_t> data;
  // A fragment's.
  std::uint32_t message_size = 0;  ///< Bytes of the message, channel not counted.
  std::uint32_t offset = 0;        ///< Of `data` in the message.
  std::uint16_t number = 0;
  std::uint16_t count = 0;
};

/// Reads LCM's two kinds of datagram, all integers big endian:
///
///     "LC02" | msg_seqno (4) | channel, 0 | data
///     "LC03" | msg_seqno (4) | msg_size (4) | fragment_offset (4) | fragment_no (2)
///            | fragments_in_msg (2) | channel, 0 (in number 0 only) | data
///
/// Whatever it accepts lies inside its message: offset + size of data <= message_size <=
/// `most_bytes`, number < count <= message_size + 1.
/// @return kNone, or the first field that cannot be.
PacketFault ReadPacket(std::span<const std::uint8_t> datagram, std::size_t most_bytes,
                       Packet& packet);

}  // namespace v2vouch::lcm_packets
