// SPDX-License-Identifier: Apache-2.0
#include "tests/support/obu_wrap.h"

#include <cctype>

namespace v2vouch {
namespace {

// Byte by byte: GCC 12 takes insert() behind an initializer list for an overflow.
void Fill(Octets& out, std::size_t count, std::uint8_t value) {
  for (std::size_t i = 0; i < count; ++i) out.push_back(value);
}

Octets OerBlock(const Octets& content) {
  Octets out;
  if (content.size() < 0x80) {
    Append(out, content.size(), 1);
  } else if (content.size() < 0x100) {
    Append(out, 0x81, 1);
    Append(out, content.size(), 1);
  } else {
    Append(out, 0x82, 1);
    Append(out, content.size(), 2);
  }
  return Joined(out, content);
}

Octets WsmpTail(const Octets& payload, std::uint32_t psid) {
  Octets out = {0x00};
  if (psid < 0x80) {
    Append(out, psid, 1);
  } else if (psid < 0x4080) {
    Append(out, 0x8000 + (psid - 0x80), 2);
  } else if (psid < 0x204080) {
    Append(out, 0xC00000 + (psid - 0x4080), 3);
  } else {
    Append(out, 0xE0000000 + (psid - 0x204080), 4);
  }
  if (payload.size() < 0x80) {
    Append(out, payload.size(), 1);
  } else {
    Append(out, 0x8000 | payload.size(), 2);
  }
  return Joined(out, payload);
}

}  // namespace

void Append(Octets& out, std::uint64_t value, std::size_t octets) {
  for (std::size_t i = octets; i-- > 0;) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

Octets Joined(const Octets& a, const Octets& b) {
  Octets out;
  out.reserve(a.size() + b.size());
  for (const std::uint8_t byte : a) out.push_back(byte);
  for (const std::uint8_t byte : b) out.push_back(byte);
  return out;
}

Octets WrapUnsecured(const Octets& payload) { return Joined({0x03, 0x80}, OerBlock(payload)); }

Octets WrapSigned(const Octets& payload, const SignedOptions& options) {
  Octets out = {0x03, 0x81, 0x00, 0x40};
  out = Joined(out, WrapUnsecured(payload));
  Append(out, options.header_extension.empty() ? 0x40 : 0xC0, 1);
  if (options.psid < 0x80) {
    Append(out, 0x0100 | options.psid, 2);
  } else {
    Append(out, 4, 1);
    Append(out, options.psid, 4);
  }
  Append(out, options.generation_us, 8);
  out = Joined(out, options.header_extension);
  Append(out, 0x80, 1);
  out = Joined(out, options.digest);
  Append(out, 0x8082, 2);
  Fill(out, 32, 0x11);
  Fill(out, 32, 0x22);
  return out;
}

Octets WrapWsmp(const Octets& payload, std::uint32_t psid) {
  return Joined({0x03}, WsmpTail(payload, psid));
}

Octets WrapWsmpWithOptions(const Octets& payload) {
  // Channel 180, rate 12, power 19, and an element that nobody knows.
  return Joined(
      {0x0B, 0x04, 0x0F, 0x01, 0xB4, 0x10, 0x01, 0x0C, 0x04, 0x01, 0x93, 0x63, 0x02, 0x00, 0x14},
      WsmpTail(payload, 0x20));
}

Octets WrapCv2x(const Octets& wsmp) { return Joined({0x01}, wsmp); }

Octets WrapEthernet(const Octets& payload, int ether_type) {
  Octets out(6, 0xFF);
  out = Joined(out, {0x02, 0x00, 0x14, 0x00, 0x20, 0x03});
  Append(out, static_cast<std::uint64_t>(ether_type), 2);
  return Joined(out, payload);
}

Octets WrapLlc(const Octets& payload, int ether_type) {
  Octets out = {0xAA, 0xAA, 0x03, 0x00, 0x00, 0x00};
  Append(out, static_cast<std::uint64_t>(ether_type), 2);
  return Joined(out, payload);
}

Octets WrapWlan(const Octets& llc, bool has_qos) {
  Octets out = {static_cast<std::uint8_t>(has_qos ? 0x88 : 0x08), 0x00, 0x00, 0x00};
  Fill(out, 6, 0xFF);
  out = Joined(out, {0x02, 0x00, 0x14, 0x00, 0x20, 0x03});
  Fill(out, 6, 0xFF);
  Append(out, 0, has_qos ? 4 : 2);
  return Joined(out, llc);
}

Octets WrapRadiotap(const Octets& wlan, int signal_dbm) {
  // Timer, flags, rate, channel, signal.
  Octets out = {0x00, 0x00, 23, 0x00, 0x2F, 0x00, 0x00, 0x00};
  Append(out, 0x0102030405060708, 8);
  out = Joined(out, {0x00, 0x0C, 0x04, 0x17, 0x00, 0x01});
  Append(out, static_cast<std::uint64_t>(signal_dbm & 0xFF), 1);
  return Joined(out, wlan);
}

Octets WrapC2p(const Octets& wlan, int kind, int rssi1, int rssi2) {
  Octets out;
  Append(out, static_cast<std::uint64_t>(kind), 1);
  Append(out, 0x2B14E53B, 4);
  Append(out, 123, 4);
  Append(out, 180, 1);
  if (kind >> 4 == 1) Append(out, 0xB201, 2);
  Append(out, 0x0C01, 2);
  Append(out, 404740535, 4);
  Append(out, static_cast<std::uint32_t>(-1049692289), 4);
  Append(out, 1234, 2);
  Append(out, 3601, 2);
  if ((kind & 0x0F) == 2) {
    Append(out, 0x177F7F, 3);
  } else {
    Append(out, static_cast<std::uint64_t>(rssi1 & 0xFF), 1);
    Append(out, static_cast<std::uint64_t>(rssi2 & 0xFF), 1);
    Append(out, 0xA1A100640064, 6);
  }
  return Joined(out, wlan);
}

Octets WrapC2pCv2x(const Octets& payload, int rssi) {
  Octets out = {0x23};
  Append(out, 0x2B14E53B, 4);
  Append(out, 123, 4);
  Append(out, 0x0088DC, 3);
  Append(out, static_cast<std::uint64_t>(rssi & 0xFF), 1);
  Append(out, 0x0C, 1);
  return Joined(out, payload);
}

Octets WrapCohda(const Octets& message, int btp_port) {
  Octets inside = {0x02, 0x07, 0x00, 0x05};
  Append(inside, static_cast<std::uint64_t>(btp_port), 2);
  Fill(inside, 2 + 4 + 4 + 2 + 2 + 2 + 1 + 1, 0x00);
  inside = Joined(inside, {0x02, 0x00, 0x00, 0x03});
  Append(inside, 36, 4);
  Fill(inside, 32, 0x00);
  inside = Joined(inside, {0xAF, 0xC4, 0x62, 0x73, 0xF7, 0x60, 0x13, 0x7E});
  Append(inside, message.size(), 2);
  inside = Joined(inside, message);
  Octets out = {0x04, 0x01};
  Append(out, inside.size(), 2);
  return Joined(out, inside);
}

Octets WrapBtp(const Octets& message, int port) {
  Octets out;
  Append(out, static_cast<std::uint64_t>(port), 2);
  Append(out, 0, 2);
  return Joined(out, message);
}

Octets WrapGeo(const Octets& btp, std::uint32_t timestamp_ms) {
  Octets out = {0x11, 0x00, 0x05, 0x01, 0x20, 0x50, 0x02, 0x80};
  Append(out, btp.size(), 2);
  Append(out, 0x0100, 2);
  Append(out, 0x14008AB0F8A8A225, 8);
  Append(out, timestamp_ms, 4);
  Fill(out, 12 + 4, 0x00);
  return Joined(out, btp);
}

Octets WrapUdp(const Octets& payload, int port, bool is_ipv6) {
  Octets udp;
  Append(udp, 40000, 2);
  Append(udp, static_cast<std::uint64_t>(port), 2);
  Append(udp, payload.size() + 8, 2);
  Append(udp, 0, 2);
  udp = Joined(udp, payload);
  Octets out;
  if (is_ipv6) {
    Append(out, 0x60000000, 4);
    Append(out, udp.size(), 2);
    Append(out, 0x1140, 2);
    Fill(out, 32, 0x20);
  } else {
    Append(out, 0x4500, 2);
    Append(out, udp.size() + 20, 2);
    Append(out, 0x0001400040110000, 8);
    Append(out, 0xC0A85828, 4);
    Append(out, 0xC0A8580A, 4);
  }
  return Joined(out, udp);
}

Octets HexText(const Octets& bytes, bool upper, std::size_t line) {
  Octets out;
  std::size_t column = 0;
  for (const char letter : HexText(bytes)) {
    out.push_back(static_cast<std::uint8_t>(upper ? std::toupper(letter) : letter));
    if (line > 0 && ++column % line == 0) out.push_back('\n');
  }
  return out;
}

Octets RsuText(const Octets& bytes) {
  std::string text =
      "Version=0.7\nType=BSM\nPSID=0x20\nPriority=6\nTxMode=ALT\nTxChannel=183\nTxInterval=0\n"
      "DeliveryStart=\nDeliveryStop=\nSignature=False\nEncryption=False\nPayload=";
  const Octets hex = HexText(bytes, true);
  text.append(hex.begin(), hex.end());
  text += "\n";
  return Octets(text.begin(), text.end());
}

}  // namespace v2vouch
