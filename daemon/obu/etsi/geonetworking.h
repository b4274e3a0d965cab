// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {

inline constexpr std::uint16_t kBtpPortCam = 2001;

/// GeoNetworking packet (ETSI EN 302 636-4-1) without its payload.
struct GeoNetworking {
  bool is_secured = false;
  std::uint8_t header_type = 0;    ///< Type and subtype: 0x50 single hop, 0x40.. geo broadcast.
  std::uint8_t next = 0;           ///< 1 BTP-A, 2 BTP-B.
  std::uint32_t timestamp_ms = 0;  ///< Of the source's position: ms since 2004 (TAI), low 32 bits.
  std::size_t trailing = 0;
};

/// Whether `bytes` can begin a packet: version 1, next header 1 or 2, reserved byte 0.
bool LooksLikeGeoNetworking(Bytes bytes);

/// Basic header. @param rest common header (plain) or IEEE 1609.2 data (secured).
Fault ReadGeoBasicHeader(Bytes bytes, GeoNetworking& geo, Bytes& rest);

/// Common and extended header. @param payload what they carry.
Fault ReadGeoCommonHeader(Bytes bytes, GeoNetworking& geo, Bytes& payload);

/// BTP-B (or BTP-A): destination port, then the message.
Fault ReadBtp(Bytes bytes, std::uint16_t& port, Bytes& payload);

}  // namespace v2vouch::obu
