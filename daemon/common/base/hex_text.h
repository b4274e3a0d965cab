// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace v2vouch {

/// Two hex digits a byte, in lower case, nothing between them.
std::string HexText(std::span<const std::uint8_t> bytes);
/// The same in upper case.
std::string UpperHexText(std::span<const std::uint8_t> bytes);

}  // namespace v2vouch
