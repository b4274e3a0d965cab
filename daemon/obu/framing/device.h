// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "daemon/obu/framing/link.h"
#include "daemon/obu/ieee1609/certificate.h"

namespace v2vouch::obu {

inline constexpr std::uint16_t kPortC2p = 7943;
inline constexpr std::uint16_t kPortRsu = 1516;

/// Header of Commsignia's capture protocol. Layout from Commsignia's own dissectors (2015, 2025).
struct C2p {
  bool is_transmission = false;  ///< The unit's own.
  std::optional<int> rssi_dbm;   ///< The stronger antenna.
  int channel = 0;
  std::uint32_t seconds = 0;  ///< Since 2004, by the unit's clock.
  std::uint32_t milliseconds = 0;
};
/// Forms of versions 0 and 1: an 802.11 frame follows.
Fault ReadC2p(Bytes bytes, C2p& c2p, Bytes& wlan);
/// Form for C-V2X reception: payload with its Ethernet type.
Fault ReadC2pCv2x(Bytes bytes, C2p& c2p, LinkPayload& payload);

/// Indication of Cohda's ETSI interface, version 4 (layout of fzi's public driver).
struct Cohda {
  std::uint16_t btp_port = 0;
  int parse_result = 0;
  int verify_result = 0;  ///< Codes not checked on a unit: shown, nothing follows from them.
  std::uint32_t its_aid = 0;
  HashedId8 certificate_digest{};
};
/// Whether `bytes` can begin an indication: version 4, id 1, and a length that fits.
bool LooksLikeCohda(Bytes bytes);
Fault ReadCohda(Bytes bytes, Cohda& cohda, Bytes& message);

}  // namespace v2vouch::obu
