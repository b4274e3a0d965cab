// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {

inline constexpr int kEtherTypeWsmp = 0x88DC;
inline constexpr int kEtherTypeGeo = 0x8947;
inline constexpr int kEtherTypeIpv4 = 0x0800;
inline constexpr int kEtherTypeIpv6 = 0x86DD;

/// What a link layer carries.
struct LinkPayload {
  int ether_type = 0;
  Bytes bytes;
  std::size_t may_trail = 4;  ///< Bytes that may follow the payload: check sequence, padding.
};

/// Ethernet II header, up to two VLAN tags.
Fault ReadEthernet(Bytes bytes, LinkPayload& payload);

/// Linux "cooked" capture header (link types 113 and 276).
Fault ReadLinuxCooked(Bytes bytes, bool is_version_2, LinkPayload& payload);

/// 802.11 data or QoS data header.
Fault ReadWlan(Bytes bytes, Bytes& rest);

/// 802.2 LLC with SNAP: AA AA 03 00 00 00, then the Ethernet type.
Fault ReadLlc(Bytes bytes, LinkPayload& payload);

struct Radiotap {
  std::optional<int> signal_dbm;
  bool has_check_sequence = false;
};
Fault ReadRadiotap(Bytes bytes, Radiotap& radiotap, Bytes& rest);

struct UdpPacket {
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;
  std::array<std::uint8_t, 16> source{};  ///< IPv4 in the first four.
  bool is_ipv6 = false;
  Bytes payload;

  /// "192.168.88.40", "[2001:db8:0:0:0:0:0:1]".
  [[nodiscard]] std::string source_text() const;
};
/// IPv4 or IPv6, then UDP: kIpFragment for pieces, kNotV2x for other protocols.
Fault ReadUdpPacket(Bytes bytes, UdpPacket& packet);

}  // namespace v2vouch::obu
