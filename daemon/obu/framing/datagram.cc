// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/framing/datagram.h"

#include <algorithm>

#include "daemon/obu/framing/peeler.h"
#include "daemon/obu/framing/text.h"

namespace v2vouch::obu {
namespace {

// Whether a framing was the right one, whatever came of its content.
bool IsContentFault(FaultKind kind) {
  switch (kind) {
    case FaultKind::kNone:
    case FaultKind::kOutOfRange:
    case FaultKind::kNotBsm:
    case FaultKind::kNotCam:
    case FaultKind::kNotVehicle:
    case FaultKind::kWrongPsid:
    case FaultKind::kOwnTransmission:
    case FaultKind::kEncrypted:
    case FaultKind::kNestedTooDeep:
    case FaultKind::kNotV2x:
      return true;
    default:
      return false;
  }
}

bool CanBegin(Layer framing, Bytes bytes, const DatagramOptions& options) {
  const ByteReader reader(bytes);
  const auto type_at = [&](std::size_t at) { return reader.Peek(at) * 256 + reader.Peek(at + 1); };
  switch (framing) {
    case Layer::kFrame:
      return reader.Peek(1) >= 0 &&
             !MessageName((reader.Peek() & 0x7F) * 256 + reader.Peek(1)).empty();
    case Layer::kDot2:
      return LooksLikeDot2(bytes);
    case Layer::kWsmp:
      return LooksLikeWsmp(bytes);
    case Layer::kCv2x:
      return reader.Peek() == 1 && LooksLikeWsmp(bytes.subspan(1));
    case Layer::kC2p:
      return options.port == kPortC2p || reader.Peek() == 0x01 || reader.Peek() == 0x02 ||
             reader.Peek() == 0x11 || reader.Peek() == 0x12 || type_at(10) == kEtherTypeWsmp ||
             type_at(10) == kEtherTypeGeo;
    case Layer::kEthernet:
      return type_at(12) == kEtherTypeWsmp || type_at(12) == kEtherTypeGeo || type_at(12) == 0x8100;
    case Layer::kRadiotap:
      return reader.Peek() == 0 && reader.Peek(1) == 0 && reader.Peek(3) >= 0;
    case Layer::kWlan:
      return reader.Peek() == 0x08 || reader.Peek() == 0x88;
    case Layer::kLlc:
      return reader.Peek() == 0xAA && reader.Peek(1) == 0xAA && reader.Peek(2) == 3;
    case Layer::kCohda:
      return LooksLikeCohda(bytes);
    case Layer::kGeo:
      return LooksLikeGeoNetworking(bytes);
    case Layer::kBtp:
      return reader.Peek() == kBtpPortCam / 256 && reader.Peek(1) == kBtpPortCam % 256 &&
             bytes.size() > 4 && LooksLikeCam(bytes.subspan(4));
    case Layer::kCam:
      return LooksLikeCam(bytes);
    default:
      return false;
  }
}

constexpr Layer kOrder[] = {Layer::kFrame, Layer::kDot2,     Layer::kWsmp,     Layer::kCv2x,
                            Layer::kC2p,   Layer::kEthernet, Layer::kRadiotap, Layer::kWlan,
                            Layer::kLlc,   Layer::kCohda,    Layer::kGeo,      Layer::kBtp,
                            Layer::kCam};

// Tries what can begin like this, in order; the first that fits is it. `base` holds the layers
// round the datagram.
void ReadBinary(Bytes bytes, const DatagramOptions& options, const Datagram& base,
                Datagram& datagram) {
  constexpr std::size_t kCheckSequence = 4;
  if (bytes.empty()) {
    datagram.fault = {FaultKind::kEmpty, "datagram"};
    return;
  }
  if (bytes.size() > kLongestDatagram) {
    datagram.fault = {FaultKind::kTooLong, "datagram", static_cast<std::int64_t>(bytes.size())};
    return;
  }
  bool has_candidate = false;
  Datagram best = base;
  const auto attempt = [&](Layer framing) {
    datagram = base;
    Peeler peeler(datagram);
    datagram.fault = peeler.Peel(framing, bytes, kCheckSequence);
    if (IsContentFault(datagram.fault.kind)) return true;
    if (!has_candidate) best = datagram;
    has_candidate = true;
    return false;
  };
  if (options.framing) {
    attempt(*options.framing);
    return;
  }
  const bool is_c2p_port = options.port == kPortC2p;
  if (is_c2p_port && attempt(Layer::kC2p)) return;
  for (const Layer framing : kOrder) {
    if (is_c2p_port && framing == Layer::kC2p) continue;
    if (CanBegin(framing, bytes, options) && attempt(framing)) return;
  }
  datagram = best;
  if (!has_candidate) {
    // A lone byte can be the beginning of anything.
    datagram.fault = bytes.size() < 2 ? Fault{FaultKind::kTruncated, "datagram"}
                                      : Fault{FaultKind::kUnknownFraming, "datagram"};
  }
}

void ReadWithBase(Bytes bytes, const DatagramOptions& options, std::span<std::uint8_t> scratch,
                  const Datagram& base, Datagram& datagram) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (options.allow_text && !options.framing) {
    Datagram inside = base;
    Bytes decoded;
    if (const auto payload = PayloadOfRsuText(text)) {
      inside.layers.Add(Layer::kRsuText);
      if (const Fault fault = ReadHex(*payload, scratch, decoded)) {
        datagram = inside;
        datagram.fault = fault;
        return;
      }
      ReadBinary(decoded, options, inside, datagram);
      return;
    }
    if (bytes.size() >= 4 && !ReadHex(text, scratch, decoded)) {
      inside.layers.Add(Layer::kHex);
      ReadBinary(decoded, options, inside, datagram);
      return;
    }
  }
  ReadBinary(bytes, options, base, datagram);
}

// IP and what is in it.
void ReadIp(Bytes bytes, DatagramOptions options, std::span<std::uint8_t> scratch, Datagram base,
            Datagram& datagram) {
  base.layers.Add(Layer::kIp);
  UdpPacket udp;
  if (const Fault fault = ReadUdpPacket(bytes, udp)) {
    datagram = base;
    datagram.fault = fault;
    return;
  }
  base.layers.Add(Layer::kUdp);
  base.udp = udp;
  options.port = udp.destination_port;
  ReadWithBase(udp.payload, options, scratch, base, datagram);
}

}  // namespace

std::span<const Layer> Framings() { return kOrder; }

std::optional<int> Datagram::rssi_dbm() const {
  if (c2p && c2p->rssi_dbm) return c2p->rssi_dbm;
  if (radiotap) return radiotap->signal_dbm;
  return std::nullopt;
}

void ReadDatagram(Bytes bytes, const DatagramOptions& options, std::span<std::uint8_t> scratch,
                  Datagram& datagram) {
  ReadWithBase(bytes, options, scratch, Datagram{}, datagram);
}

void ReadPacket(int link_type, Bytes bytes, const DatagramOptions& options,
                std::span<std::uint8_t> scratch, Datagram& datagram) {
  Datagram base;
  LinkPayload link;
  datagram = Datagram{};
  const auto is_ip = [](int type) { return type == kEtherTypeIpv4 || type == kEtherTypeIpv6; };
  switch (link_type) {
    case 1:  // Ethernet.
    case 113:
    case 276: {  // Linux "any" interface.
      const Layer layer = link_type == 1 ? Layer::kEthernet : Layer::kLinuxCooked;
      datagram.fault = link_type == 1 ? ReadEthernet(bytes, link)
                                      : ReadLinuxCooked(bytes, link_type == 276, link);
      base.layers.Add(layer);
      if (datagram.fault) break;
      if (is_ip(link.ether_type)) return ReadIp(link.bytes, options, scratch, base, datagram);
      datagram = base;
      datagram.fault = Peeler(datagram).PeelLink(link);
      return;
    }
    case 0:
    case 108:  // BSD loopback: address family, then IP.
      if (bytes.size() < 4) {
        datagram.fault = {FaultKind::kTruncated, "loopback header"};
        return;
      }
      return ReadIp(bytes.subspan(4), options, scratch, base, datagram);
    case 12:
    case 14:
    case 101:
    case 228:
    case 229:  // Raw IP.
      return ReadIp(bytes, options, scratch, base, datagram);
    case 105:
    case 127:
      datagram.fault =
          Peeler(datagram).Peel(link_type == 105 ? Layer::kWlan : Layer::kRadiotap, bytes, 4);
      return;
    default:
      datagram.fault = {FaultKind::kUnsupported, "link type", link_type};
      return;
  }
  const Fault fault = datagram.fault;
  datagram = base;
  datagram.fault = fault;
}

}  // namespace v2vouch::obu
