// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/ieee1609/wsmp.h"

namespace v2vouch::obu {
namespace {

constexpr int kHasOptions = 0x08;
constexpr int kElementTxPower = 4;
constexpr int kElementChannel = 15;
constexpr int kElementRate = 16;

// Counts and lengths: one byte below 0x80, else two with 14 bits.
std::size_t ShortLength(ByteReader& reader) {
  const std::size_t first = reader.Byte("WSMP length");
  if (first < 0x80) return first;
  if (first >= 0xC0) reader.Fail(FaultKind::kBadLength, "WSMP length");
  return ((first & 0x3FU) << 8) | reader.Byte("WSMP length");
}

void ReadOptions(ByteReader& reader, Wsmp& wsmp) {
  const std::size_t count = ShortLength(reader);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    const int id = reader.Byte("WSMP option");
    ByteReader value(reader.Take(ShortLength(reader), "WSMP option"));
    if (value.left() != 1) continue;
    const int figure = value.Byte("WSMP option");
    if (id == kElementTxPower) wsmp.tx_power_raw = figure;
    if (id == kElementChannel) wsmp.channel = figure;
    if (id == kElementRate) wsmp.rate_500kbps = figure;
  }
}

}  // namespace

std::uint32_t ReadPsid(ByteReader& reader) {
  const int first = reader.Peek();
  // Each length begins where the one below ends: 0x80, 0x4080, 0x204080.
  if (first < 0x80) return static_cast<std::uint32_t>(reader.Big(1, "PSID"));
  if (first < 0xC0) return static_cast<std::uint32_t>(reader.Big(2, "PSID") & 0x3FFFU) + 0x80;
  if (first < 0xE0) return static_cast<std::uint32_t>(reader.Big(3, "PSID") & 0x1FFFFFU) + 0x4080;
  if (first < 0xF0) {
    return static_cast<std::uint32_t>(reader.Big(4, "PSID") & 0x0FFFFFFFU) + 0x204080;
  }
  reader.Fail(FaultKind::kOutOfRange, "PSID", first);
  return 0;
}

bool LooksLikeWsmp(Bytes bytes) {
  const ByteReader reader(bytes);
  if (reader.Peek() == 0x03) return reader.Peek(1) >= 0 && reader.Peek(1) <= 5;
  return reader.Peek() == 0x0B && reader.Peek(1) >= 0 && reader.Peek(1) < 0x80;
}

Fault ReadWsmp(Bytes bytes, Wsmp& wsmp) {
  ByteReader reader(bytes);
  const int head = reader.Byte("WSMP");
  if (reader.ok() && (head & 0x07) != 3) {
    return {FaultKind::kUnsupported, "WSMP version", head & 0x07};
  }
  if (reader.ok() && (head >> 4) != 0) {
    return {FaultKind::kUnsupported, "WSMP subtype", head >> 4};
  }
  if ((head & kHasOptions) != 0) ReadOptions(reader, wsmp);
  const int tpid = reader.Byte("WSMP TPID");
  // 2 to 5 carry ports or other addresses instead of a PSID.
  if (reader.ok() && tpid > 1) return {FaultKind::kUnsupported, "WSMP TPID", tpid};
  wsmp.psid = ReadPsid(reader);
  if (tpid == 1) ReadOptions(reader, wsmp);
  wsmp.payload = reader.Take(ShortLength(reader), "WSMP payload");
  wsmp.trailing = reader.left();
  return reader.fault();
}

}  // namespace v2vouch::obu
