// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/lcm_packets/packet.h"

#include <algorithm>

namespace v2vouch::lcm_packets {
namespace {

constexpr std::uint32_t kShortMagic = 0x4C433032;     // "LC02"
constexpr std::uint32_t kFragmentMagic = 0x4C433033;  // "LC03"
constexpr std::size_t kShortHeader = 8;
constexpr std::size_t kFragmentHeader = 20;

std::uint32_t BigEndian(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes.subspan(at, size)) value = value << 8U | byte;
  return value;
}

// The channel's name from the front of `packet.data`.
bool TakeChannel(Packet& packet) {
  const auto head = packet.data.first(std::min(packet.data.size(), kLongestChannel + 1));
  const auto end = std::ranges::find(head, std::uint8_t{0});
  if (end == head.end() || end == head.begin()) return false;
  const auto length = static_cast<std::size_t>(end - head.begin());
  packet.channel = {reinterpret_cast<const char*>(head.data()), length};
  packet.data = packet.data.subspan(length + 1);
  packet.has_channel = true;
  return true;
}

PacketFault ReadFragment(std::span<const std::uint8_t> datagram, std::size_t most_bytes,
                         Packet& packet) {
  if (datagram.size() < kFragmentHeader) return PacketFault::kDatagram;
  packet.is_fragment = true;
  packet.message_size = BigEndian(datagram, 8, 4);
  packet.offset = BigEndian(datagram, 12, 4);
  packet.number = static_cast<std::uint16_t>(BigEndian(datagram, 16, 2));
  packet.count = static_cast<std::uint16_t>(BigEndian(datagram, 18, 2));
  packet.data = datagram.subspan(kFragmentHeader);

  if (packet.count == 0) return PacketFault::kFragmentCount;
  if (packet.number >= packet.count) return PacketFault::kFragmentNumber;
  const std::uint64_t size = packet.message_size;
  const std::uint64_t count = packet.count;
  if (size == 0 || size > count * kLongestDatagram) return PacketFault::kMessageSize;
  if (size > most_bytes) return PacketFault::kTooLarge;
  if (count > size + 1) return PacketFault::kFragmentCount;  // All but the first carry something.
  if (packet.number == 0 && !TakeChannel(packet)) return PacketFault::kChannel;
  if (packet.number > 0 && packet.data.empty()) return PacketFault::kEmptyFragment;
  if (packet.number == 0 && packet.offset != 0) return PacketFault::kFragmentOffset;
  // In 64 bits: nothing wraps.
  if (std::uint64_t{packet.offset} + packet.data.size() > size) return PacketFault::kFragmentOffset;
  return PacketFault::kNone;
}

}  // namespace

PacketFault ReadPacket(std::span<const std::uint8_t> datagram, std::size_t most_bytes,
                       Packet& packet) {
  packet = Packet{};
  if (datagram.size() < kShortHeader || datagram.size() > kLongestDatagram) {
    return PacketFault::kDatagram;
  }
  packet.sequence = BigEndian(datagram, 4, 4);
  const std::uint32_t magic = BigEndian(datagram, 0, 4);
  if (magic == kFragmentMagic) return ReadFragment(datagram, most_bytes, packet);
  if (magic != kShortMagic) return PacketFault::kMagic;
  packet.data = datagram.subspan(kShortHeader);
  if (!TakeChannel(packet)) return PacketFault::kChannel;
  return packet.data.size() > most_bytes ? PacketFault::kTooLarge : PacketFault::kNone;
}

}  // namespace v2vouch::lcm_packets
