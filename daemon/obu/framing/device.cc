// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/framing/device.h"

#include <algorithm>

namespace v2vouch::obu {
namespace {

constexpr int kSignalUnavailable = 127;

void ReadCommon(ByteReader& reader, C2p& c2p) {
  reader.Skip(1, "C2P");
  c2p.seconds = static_cast<std::uint32_t>(reader.Big(4, "C2P"));
  c2p.milliseconds = static_cast<std::uint32_t>(reader.Big(4, "C2P"));
}

void ReadSignal(ByteReader& reader, C2p& c2p) {
  const int dbm = static_cast<std::int8_t>(reader.Byte("C2P"));
  if (reader.ok() && dbm != kSignalUnavailable) {
    c2p.rssi_dbm = std::max(dbm, c2p.rssi_dbm.value_or(dbm));
  }
}

}  // namespace

Fault ReadC2p(Bytes bytes, C2p& c2p, Bytes& wlan) {
  ByteReader reader(bytes);
  const int kind = reader.Peek();
  if (kind < 0) return {FaultKind::kEmpty, "C2P"};
  if (kind != 0x01 && kind != 0x02 && kind != 0x11 && kind != 0x12) {
    return {FaultKind::kUnsupported, "C2P version and type", kind};
  }
  c2p.is_transmission = (kind & 0x0F) == 2;
  ReadCommon(reader, c2p);
  c2p.channel = reader.Byte("C2P");
  if (kind >> 4 == 1) reader.Skip(2, "C2P");  // Second channel, interface.
  reader.Skip(1 + 1 + 4 + 4 + 2 + 2, "C2P");  // Rate, antenna, own place and motion.
  if (c2p.is_transmission) {
    reader.Skip(3, "C2P");  // Power, signal of two antennas.
  } else {
    ReadSignal(reader, c2p);
    ReadSignal(reader, c2p);
    reader.Skip(2 + 2 + 2, "C2P");  // Noise, channel busy ratios.
  }
  wlan = reader.Rest();
  return reader.fault();
}

Fault ReadC2pCv2x(Bytes bytes, C2p& c2p, LinkPayload& payload) {
  ByteReader reader(bytes);
  ReadCommon(reader, c2p);
  reader.Skip(1, "C2P");  // Socket.
  payload.ether_type = static_cast<int>(reader.Big(2, "C2P"));
  ReadSignal(reader, c2p);
  reader.Skip(1, "C2P");  // Rate.
  payload.bytes = reader.Rest();
  payload.may_trail = 0;
  return reader.fault();
}

bool LooksLikeCohda(Bytes bytes) {
  const ByteReader reader(bytes);
  return bytes.size() >= 4 + 74 && reader.Peek() == 4 && reader.Peek(1) == 1;
}

Fault ReadCohda(Bytes bytes, Cohda& cohda, Bytes& message) {
  ByteReader outer(bytes);
  outer.Skip(2, "Cohda header");
  // The length counts what follows it, or the whole datagram.
  const auto length = static_cast<std::size_t>(outer.Big(2, "Cohda header"));
  if (outer.ok() && length != outer.left() && length != bytes.size()) {
    return {FaultKind::kBadLength, "Cohda header", static_cast<std::int64_t>(length)};
  }
  ByteReader reader(outer.Rest());
  reader.Skip(4, "Cohda indication");
  cohda.btp_port = static_cast<std::uint16_t>(reader.Big(2, "Cohda indication"));
  reader.Skip(2 + 4 + 4 + 2 + 2 + 2 + 1 + 1, "Cohda indication");
  reader.Skip(1, "Cohda security");
  cohda.parse_result = reader.Byte("Cohda security");
  cohda.verify_result = reader.Byte("Cohda security");
  reader.Skip(1, "Cohda security");
  cohda.its_aid = static_cast<std::uint32_t>(reader.Big(4, "Cohda security"));
  reader.Skip(32, "Cohda security");
  const Bytes digest = reader.Take(8, "Cohda security");
  if (reader.ok()) std::ranges::copy(digest, cohda.certificate_digest.begin());
  const auto size = static_cast<std::size_t>(reader.Big(2, "Cohda message"));
  message = reader.Take(size, "Cohda message");
  if (reader.ok() && reader.left() > 0) {
    reader.Fail(FaultKind::kTrailingBytes, "Cohda message",
                static_cast<std::int64_t>(reader.left()));
  }
  return reader.fault();
}

}  // namespace v2vouch::obu
