// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {

/// Without blanks, tabs and line breaks at either end.
std::string_view Trimmed(std::string_view text);

/// Hex digits in either case, blanks and line breaks anywhere between bytes, "0x" at the front.
/// @return the bytes, in `scratch`; kBadText for anything else.
Fault ReadHex(std::string_view text, std::span<std::uint8_t> scratch, Bytes& bytes);

}  // namespace v2vouch::obu
