// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/framing/peeler.h"

namespace v2vouch::obu {

Fault Peeler::CheckTrailing(std::size_t trailing, std::size_t may_trail, std::string_view where) {
  if (trailing > may_trail) {
    return {FaultKind::kTrailingBytes, where, static_cast<std::int64_t>(trailing)};
  }
  datagram_.trailing += trailing;
  return {};
}

Fault Peeler::Peel(Layer layer, Bytes bytes, std::size_t may_trail) {
  datagram_.layers.Add(layer);
  switch (layer) {
    case Layer::kFrame:
      return PeelFrame(bytes, may_trail);
    case Layer::kDot2:
      return PeelDot2(bytes, may_trail);
    case Layer::kWsmp:
      return PeelWsmp(bytes, may_trail);
    case Layer::kC2p:
      return PeelC2p(bytes, may_trail);
    case Layer::kGeo:
      return PeelGeo(bytes, may_trail);
    case Layer::kBtp:
      return PeelBtp(bytes);
    case Layer::kCam:
      return PeelCam(bytes);
    case Layer::kWlan:
      return PeelWlan(bytes);
    case Layer::kCohda:
      return PeelCohda(bytes);
    case Layer::kCv2x: {
      ByteReader reader(bytes);
      if (reader.Byte("C-V2X family") != 1) return {FaultKind::kUnknownFraming, "C-V2X family"};
      return Peel(Layer::kWsmp, reader.Rest(), may_trail);
    }
    case Layer::kEthernet: {
      LinkPayload payload;
      if (const Fault fault = ReadEthernet(bytes, payload)) return fault;
      return PeelLink(payload);
    }
    case Layer::kLlc: {
      LinkPayload payload;
      if (const Fault fault = ReadLlc(bytes, payload)) return fault;
      return PeelLink(payload);
    }
    case Layer::kRadiotap: {
      Bytes rest;
      datagram_.radiotap.emplace();
      if (const Fault fault = ReadRadiotap(bytes, *datagram_.radiotap, rest)) return fault;
      return Peel(Layer::kWlan, rest, 0);
    }
    default:
      return {FaultKind::kUnsupported, LayerName(layer)};
  }
}

Fault Peeler::PeelLink(const LinkPayload& payload) {
  if (payload.ether_type == kEtherTypeGeo) {
    return Peel(Layer::kGeo, payload.bytes, payload.may_trail);
  }
  if (payload.ether_type != kEtherTypeWsmp) {
    return {FaultKind::kNotV2x, "Ethernet type", payload.ether_type};
  }
  // Some C-V2X units leave their family byte in.
  const bool has_family =
      payload.bytes.size() > 1 && payload.bytes[0] == 1 && LooksLikeWsmp(payload.bytes.subspan(1));
  return Peel(has_family ? Layer::kCv2x : Layer::kWsmp, payload.bytes, payload.may_trail);
}

Fault Peeler::PeelWlan(Bytes bytes) {
  Bytes rest;
  if (const Fault fault = ReadWlan(bytes, rest)) return fault;
  return Peel(Layer::kLlc, rest, 0);
}

Fault Peeler::PeelC2p(Bytes bytes, std::size_t) {
  datagram_.c2p.emplace();
  Bytes wlan;
  Fault fault = ReadC2p(bytes, *datagram_.c2p, wlan);
  Bytes rest;
  // The form of 2025 for C-V2X has an Ethernet type where others have their own place.
  if (fault || ReadWlan(wlan, rest)) {
    C2p c2p;
    LinkPayload payload;
    if (!ReadC2pCv2x(bytes, c2p, payload) &&
        (payload.ether_type == kEtherTypeWsmp || payload.ether_type == kEtherTypeGeo)) {
      datagram_.c2p = c2p;
      return PeelLink(payload);
    }
  }
  if (fault) return fault;
  fault = Peel(Layer::kWlan, wlan, 0);
  // A frame of another kind on a capture port is no V2X; off it, the framing was guessed wrongly.
  if (fault.kind == FaultKind::kNotV2x) fault.kind = FaultKind::kUnsupported;
  if (!fault && datagram_.c2p->is_transmission) return {FaultKind::kOwnTransmission, "C2P"};
  return fault;
}

Fault Peeler::PeelWsmp(Bytes bytes, std::size_t may_trail) {
  datagram_.wsmp.emplace();
  if (const Fault fault = ReadWsmp(bytes, *datagram_.wsmp)) return fault;
  const Wsmp& wsmp = *datagram_.wsmp;
  if (const Fault fault = CheckTrailing(wsmp.trailing, may_trail, "WSMP")) return fault;
  if (LooksLikeDot2(wsmp.payload)) return Peel(Layer::kDot2, wsmp.payload, 0);
  return Peel(Layer::kFrame, wsmp.payload, 0);
}

Fault Peeler::PeelDot2(Bytes bytes, std::size_t may_trail) {
  datagram_.dot2.emplace();
  Dot2Data& dot2 = *datagram_.dot2;
  if (const Fault fault = ReadDot2(bytes, dot2)) return fault;
  // Cut off inside the signature: damaged, not merely beyond us.
  if (dot2.security_fault.kind == FaultKind::kTruncated) return dot2.security_fault;
  if (const Fault fault = CheckTrailing(dot2.trailing, may_trail, "1609.2")) return fault;
  if (datagram_.geo) return PeelGeoCommon(dot2.payload, 0);
  return Peel(Layer::kFrame, dot2.payload, 0);
}

Fault Peeler::PeelFrame(Bytes bytes, std::size_t may_trail) {
  MessageFrame frame;
  if (const Fault fault = ReadMessageFrame(bytes, frame)) return fault;
  datagram_.frame = frame;
  // Behind a frame with its extension bit set come the additions: not read, never a fault.
  if (!frame.has_extensions) {
    if (const Fault fault = CheckTrailing(frame.trailing, may_trail, "MessageFrame")) return fault;
  }
  datagram_.bsm.emplace();
  if (const Fault fault = ReadBsm(frame, *datagram_.bsm)) {
    datagram_.bsm.reset();
    return fault;
  }
  // An envelope for another application does not carry BSMs.
  if (datagram_.wsmp && datagram_.wsmp->psid != kPsidBsm) {
    return {FaultKind::kWrongPsid, "WSMP PSID", datagram_.wsmp->psid};
  }
  if (datagram_.dot2 && datagram_.dot2->content == Dot2Data::Content::kSigned &&
      datagram_.dot2->psid != kPsidBsm) {
    return {FaultKind::kWrongPsid, "1609.2 PSID", datagram_.dot2->psid};
  }
  return {};
}

Fault Peeler::PeelGeo(Bytes bytes, std::size_t may_trail) {
  datagram_.geo.emplace();
  Bytes rest;
  if (const Fault fault = ReadGeoBasicHeader(bytes, *datagram_.geo, rest)) return fault;
  if (datagram_.geo->is_secured) return Peel(Layer::kDot2, rest, may_trail);
  return PeelGeoCommon(rest, may_trail);
}

Fault Peeler::PeelGeoCommon(Bytes bytes, std::size_t may_trail) {
  Bytes payload;
  if (const Fault fault = ReadGeoCommonHeader(bytes, *datagram_.geo, payload)) return fault;
  if (const Fault fault = CheckTrailing(datagram_.geo->trailing, may_trail, "GeoNetworking")) {
    return fault;
  }
  if (payload.empty()) return {FaultKind::kNotCam, "GeoNetworking beacon", 0};
  return Peel(Layer::kBtp, payload, 0);
}

Fault Peeler::PeelBtp(Bytes bytes) {
  std::uint16_t port = 0;
  Bytes payload;
  if (const Fault fault = ReadBtp(bytes, port, payload)) return fault;
  datagram_.btp_port = port;
  if (port != kBtpPortCam) return {FaultKind::kNotCam, "BTP port", port};
  return Peel(Layer::kCam, payload, 0);
}

Fault Peeler::PeelCohda(Bytes bytes) {
  datagram_.cohda.emplace();
  Bytes message;
  if (const Fault fault = ReadCohda(bytes, *datagram_.cohda, message)) return fault;
  datagram_.btp_port = datagram_.cohda->btp_port;
  if (datagram_.cohda->btp_port != kBtpPortCam) {
    return {FaultKind::kNotCam, "BTP port", datagram_.cohda->btp_port};
  }
  return Peel(Layer::kCam, message, 0);
}

Fault Peeler::PeelCam(Bytes bytes) {
  Cam cam;
  if (const Fault fault = ReadCam(bytes, cam)) return fault;
  if (datagram_.dot2 && datagram_.dot2->content == Dot2Data::Content::kSigned &&
      datagram_.dot2->psid != kPsidCam) {
    return {FaultKind::kWrongPsid, "1609.2 PSID", datagram_.dot2->psid};
  }
  datagram_.cam = cam;
  return {};
}

}  // namespace v2vouch::obu
