// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/framing/link.h"

#include <algorithm>

namespace v2vouch::obu {
namespace {

constexpr int kEtherTypeVlan = 0x8100;
constexpr int kEtherTypeVlanOuter = 0x88A8;
constexpr int kProtocolUdp = 17;
// Shorter Ethernet payloads are filled up to this; then a check sequence of four bytes may follow.
constexpr std::size_t kEthernetLeast = 46;

}  // namespace

Fault ReadEthernet(Bytes bytes, LinkPayload& payload) {
  ByteReader reader(bytes);
  reader.Skip(12, "Ethernet");
  payload.ether_type = static_cast<int>(reader.Big(2, "Ethernet"));
  for (int tags = 0; tags < 2 && (payload.ether_type == kEtherTypeVlan ||
                                  payload.ether_type == kEtherTypeVlanOuter);
       ++tags) {
    reader.Skip(2, "VLAN tag");
    payload.ether_type = static_cast<int>(reader.Big(2, "VLAN tag"));
  }
  payload.bytes = reader.Rest();
  payload.may_trail = payload.bytes.size() <= kEthernetLeast + 4 ? kEthernetLeast : 4;
  return reader.fault();
}

Fault ReadLinuxCooked(Bytes bytes, bool is_version_2, LinkPayload& payload) {
  ByteReader reader(bytes);
  if (is_version_2) {
    payload.ether_type = static_cast<int>(reader.Big(2, "Linux cooked header"));
    reader.Skip(18, "Linux cooked header");
  } else {
    reader.Skip(14, "Linux cooked header");
    payload.ether_type = static_cast<int>(reader.Big(2, "Linux cooked header"));
  }
  payload.bytes = reader.Rest();
  payload.may_trail = kEthernetLeast;
  return reader.fault();
}

Fault ReadWlan(Bytes bytes, Bytes& rest) {
  ByteReader reader(bytes);
  const int control = reader.Byte("802.11");
  const int flags = reader.Byte("802.11");
  if (!reader.ok()) return reader.fault();
  // Version 0, type data, and not one of the subtypes without content.
  if ((control & 0x0F) != 0x08 || (control & 0x70) != 0) {
    return {FaultKind::kNotV2x, "802.11 frame", control};
  }
  if ((flags & 0x40) != 0) return {FaultKind::kEncrypted, "802.11"};
  std::size_t more = 24 - 2;
  if ((flags & 0x03) == 0x03) more += 6;  // To and from a distribution system: a fourth address.
  const bool has_qos = (control & 0x80) != 0;
  if (has_qos) more += 2;
  if (has_qos && (flags & 0x80) != 0) more += 4;  // HT control.
  reader.Skip(more, "802.11");
  rest = reader.Rest();
  return reader.fault();
}

Fault ReadLlc(Bytes bytes, LinkPayload& payload) {
  ByteReader reader(bytes);
  const std::uint64_t head = reader.Big(6, "LLC");
  payload.ether_type = static_cast<int>(reader.Big(2, "LLC"));
  payload.bytes = reader.Rest();
  payload.may_trail = 4;
  if (reader.ok() && head != 0xAAAA03000000U) return {FaultKind::kUnsupported, "LLC"};
  return reader.fault();
}

Fault ReadRadiotap(Bytes bytes, Radiotap& radiotap, Bytes& rest) {
  ByteReader reader(bytes);
  const int version = reader.Byte("radiotap");
  reader.Skip(1, "radiotap");
  const auto size = static_cast<std::size_t>(reader.Little(2, "radiotap"));
  if (!reader.ok()) return reader.fault();
  if (version != 0) return {FaultKind::kUnsupported, "radiotap version", version};
  if (size < 8) return {FaultKind::kBadLength, "radiotap", static_cast<std::int64_t>(size)};
  if (size > bytes.size()) return {FaultKind::kTruncated, "radiotap"};
  rest = bytes.subspan(size);

  // Presence words, chained by their highest bit; then the fields, aligned within the header.
  // Nothing of them is needed: what cannot be read is left out.
  ByteReader fields(bytes.first(size));
  fields.Skip(4, "radiotap");
  const auto present = static_cast<std::uint32_t>(fields.Little(4, "radiotap"));
  for (std::uint32_t word = present; (word >> 31) != 0 && fields.ok();) {
    word = static_cast<std::uint32_t>(fields.Little(4, "radiotap"));
  }
  const auto align = [&fields](std::size_t to) {
    if (fields.position() % to != 0) fields.Skip(to - fields.position() % to, "radiotap");
  };
  if ((present & 0x01) != 0) {  // Timer.
    align(8);
    fields.Skip(8, "radiotap");
  }
  if ((present & 0x02) != 0) {
    const int flags = fields.Byte("radiotap");
    radiotap.has_check_sequence = fields.ok() && (flags & 0x10) != 0;
  }
  if ((present & 0x04) != 0) fields.Skip(1, "radiotap");  // Rate.
  if ((present & 0x08) != 0) {                            // Channel.
    align(2);
    fields.Skip(4, "radiotap");
  }
  if ((present & 0x10) != 0) fields.Skip(2, "radiotap");  // Hopping.
  if ((present & 0x20) != 0) {
    const auto signal = static_cast<std::int8_t>(fields.Byte("radiotap"));
    if (fields.ok()) radiotap.signal_dbm = signal;
  }
  return {};
}

Fault ReadUdpPacket(Bytes bytes, UdpPacket& packet) {
  ByteReader reader(bytes);
  const int first = reader.Byte("IP");
  if (!reader.ok()) return reader.fault();
  std::size_t size = 0;
  if (first >> 4 == 4) {
    const std::size_t header = static_cast<std::size_t>(first & 0x0F) * 4;
    reader.Skip(1, "IP");
    const auto total = static_cast<std::size_t>(reader.Big(2, "IP"));
    reader.Skip(2, "IP");
    const auto fragment = static_cast<unsigned>(reader.Big(2, "IP"));
    reader.Skip(1, "IP");
    const int protocol = reader.Byte("IP");
    reader.Skip(2, "IP");
    const Bytes source = reader.Take(4, "IP");
    reader.Skip(4, "IP");
    if (!reader.ok()) return reader.fault();
    if (header < 20 || total < header) return {FaultKind::kBadLength, "IP"};
    if (protocol != kProtocolUdp) return {FaultKind::kNotV2x, "IP protocol", protocol};
    if ((fragment & 0x3FFF) != 0) return {FaultKind::kIpFragment, "IP"};
    std::ranges::copy(source, packet.source.begin());
    reader.Skip(header - 20, "IP");
    size = total - header;
  } else if (first >> 4 == 6) {
    packet.is_ipv6 = true;
    reader.Skip(3, "IPv6");
    size = static_cast<std::size_t>(reader.Big(2, "IPv6"));
    const int next = reader.Byte("IPv6");
    reader.Skip(1, "IPv6");
    const Bytes source = reader.Take(16, "IPv6");
    reader.Skip(16, "IPv6");
    if (!reader.ok()) return reader.fault();
    std::ranges::copy(source, packet.source.begin());
    if (next == 44) return {FaultKind::kIpFragment, "IPv6"};
    if (next != kProtocolUdp) return {FaultKind::kNotV2x, "IP protocol", next};
  } else {
    return {FaultKind::kNotV2x, "IP version", first >> 4};
  }
  ByteReader udp(reader.Take(size, "IP"));
  if (!reader.ok()) return reader.fault();
  packet.source_port = static_cast<std::uint16_t>(udp.Big(2, "UDP"));
  packet.destination_port = static_cast<std::uint16_t>(udp.Big(2, "UDP"));
  const auto length = static_cast<std::size_t>(udp.Big(2, "UDP"));
  udp.Skip(2, "UDP");
  if (udp.ok() && length < 8) return {FaultKind::kBadLength, "UDP"};
  packet.payload = udp.Take(length - 8, "UDP");
  return udp.fault();
}

std::string UdpPacket::source_text() const {
  std::string text;
  if (!is_ipv6) {
    for (std::size_t i = 0; i < 4; ++i) {
      text += (i == 0 ? "" : ".") + std::to_string(source[i]);
    }
    return text;
  }
  for (std::size_t i = 0; i < 16; i += 2) {
    char group[8];
    std::snprintf(group, sizeof group, "%s%x", i == 0 ? "" : ":", source[i] * 256U + source[i + 1]);
    text += group;
  }
  return "[" + text + "]";
}

}  // namespace v2vouch::obu
