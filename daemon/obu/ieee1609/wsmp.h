// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {

inline constexpr std::uint32_t kPsidBsm = 0x20;
inline constexpr std::uint32_t kPsidCam = 36;  ///< ITS-AID of the cooperative awareness service.

/// WAVE short message of IEEE 1609.3-2016/2020, version 3, null networking.
struct Wsmp {
  std::uint32_t psid = 0;
  std::optional<int> channel;
  std::optional<int> rate_500kbps;
  std::optional<int> tx_power_raw;  ///< As sent: units differ in its bias. Never decide on it.
  Bytes payload;
  std::size_t trailing = 0;  ///< Bytes behind the announced length.
};

/// Whether `bytes` can begin a message that ReadWsmp() reads.
bool LooksLikeWsmp(Bytes bytes);
Fault ReadWsmp(Bytes bytes, Wsmp& wsmp);

/// A PSID in p-encoding (IEEE 1609.12): 1 to 4 bytes, each length with an offset of its own.
std::uint32_t ReadPsid(ByteReader& reader);

}  // namespace v2vouch::obu
