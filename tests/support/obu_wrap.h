// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "tests/support/obu_samples.h"

namespace v2vouch {

/// Builders of the framings that units and scripts use, for tests.
void Append(Octets& out, std::uint64_t value, std::size_t octets);
Octets Joined(const Octets& a, const Octets& b);

Octets WrapUnsecured(const Octets& payload);  ///< IEEE 1609.2, unsecured.
struct SignedOptions {
  std::uint32_t psid = 0x20;
  std::uint64_t generation_us = 700000000000000;
  Octets digest = {1, 2, 3, 4, 5, 6, 7, 8};
  Octets header_extension;  ///< Bytes of an extension of the header; empty = none.
};
Octets WrapSigned(const Octets& payload,
                  const SignedOptions& options = {});  ///< Made-up signature.
Octets WrapWsmp(const Octets& payload, std::uint32_t psid = 0x20);
Octets WrapWsmpWithOptions(const Octets& payload);
Octets WrapCv2x(const Octets& wsmp);
Octets WrapEthernet(const Octets& payload, int ether_type = 0x88DC);
Octets WrapLlc(const Octets& payload, int ether_type = 0x88DC);
Octets WrapWlan(const Octets& llc, bool has_qos = true);
Octets WrapRadiotap(const Octets& wlan, int signal_dbm);
/// kind 0x01, 0x11 received; 0x02, 0x12 transmitted.
Octets WrapC2p(const Octets& wlan, int kind, int rssi1 = -70, int rssi2 = 127);
Octets WrapC2pCv2x(const Octets& payload, int rssi);
Octets WrapCohda(const Octets& message, int btp_port = 2001);
Octets WrapBtp(const Octets& message, int port = 2001);
Octets WrapGeo(const Octets& btp, std::uint32_t timestamp_ms = 0);
Octets WrapUdp(const Octets& payload, int port, bool is_ipv6 = false);  ///< IP packet.
Octets HexText(const Octets& bytes, bool upper, std::size_t line = 0);
Octets RsuText(const Octets& bytes);

}  // namespace v2vouch
