// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {

/// Longest datagram looked at: a message and its envelopes stay under 1500 bytes.
inline constexpr std::size_t kLongestDatagram = 2304;

/// Hex digits in either case, blanks and line breaks anywhere between bytes, "0x" at the front.
/// @return the bytes, in `scratch`; kBadText for anything else.
Fault ReadHex(std::string_view text, std::span<std::uint8_t> scratch, Bytes& bytes);

/// The payload of an RSU 4.1 message file ("Version=0.7", "Payload=0014..."); nullopt where `text`
/// is none.
std::optional<std::string_view> PayloadOfRsuText(std::string_view text);

}  // namespace v2vouch::obu
