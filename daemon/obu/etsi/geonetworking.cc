// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/etsi/geonetworking.h"

namespace v2vouch::obu {
namespace {

constexpr std::size_t kLongPosition = 24;

// What stands before the source's position vector and behind it, by header type (clause 9.8).
struct Extended {
  std::size_t before;
  std::size_t behind;
};

std::optional<Extended> ExtendedHeader(int header_type) {
  switch (header_type >> 4) {
    case 1:
      return Extended{0, 0};  // Beacon.
    case 2:
      return Extended{4, 20};  // Geo unicast.
    case 3:
      return Extended{4, 16};  // Geo anycast.
    case 4:
      return Extended{4, 16};  // Geo broadcast.
    case 5:
      return header_type == 0x50 ? Extended{0, 4} : Extended{4, 0};
    default:
      return std::nullopt;
  }
}

}  // namespace

bool LooksLikeGeoNetworking(Bytes bytes) {
  const ByteReader reader(bytes);
  return (reader.Peek() == 0x11 || reader.Peek() == 0x12) && reader.Peek(1) == 0;
}

Fault ReadGeoBasicHeader(Bytes bytes, GeoNetworking& geo, Bytes& rest) {
  ByteReader reader(bytes);
  const int head = reader.Byte("GeoNetworking");
  reader.Skip(3, "GeoNetworking");
  if (!reader.ok()) return reader.fault();
  if (head >> 4 > 1) return {FaultKind::kUnsupported, "GeoNetworking version", head >> 4};
  const int next = head & 0x0F;
  if (next != 1 && next != 2) return {FaultKind::kUnsupported, "GeoNetworking next header", next};
  geo.is_secured = next == 2;
  rest = reader.Rest();
  return {};
}

Fault ReadGeoCommonHeader(Bytes bytes, GeoNetworking& geo, Bytes& payload) {
  ByteReader reader(bytes);
  geo.next = static_cast<std::uint8_t>(reader.Byte("GeoNetworking common header") >> 4);
  geo.header_type = reader.Byte("GeoNetworking common header");
  reader.Skip(2, "GeoNetworking common header");
  const auto size = static_cast<std::size_t>(reader.Big(2, "GeoNetworking common header"));
  reader.Skip(2, "GeoNetworking common header");
  if (!reader.ok()) return reader.fault();
  const auto extended = ExtendedHeader(geo.header_type);
  if (!extended) return {FaultKind::kUnsupported, "GeoNetworking header type", geo.header_type};
  reader.Skip(extended->before + 8, "GeoNetworking position");
  geo.timestamp_ms = static_cast<std::uint32_t>(reader.Big(4, "GeoNetworking position"));
  reader.Skip(kLongPosition - 12 + extended->behind, "GeoNetworking position");
  payload = reader.Take(size, "GeoNetworking payload");
  geo.trailing = reader.left();
  return reader.fault();
}

Fault ReadBtp(Bytes bytes, std::uint16_t& port, Bytes& payload) {
  ByteReader reader(bytes);
  port = static_cast<std::uint16_t>(reader.Big(2, "BTP"));
  reader.Skip(2, "BTP");
  payload = reader.Rest();
  return reader.fault();
}

}  // namespace v2vouch::obu
