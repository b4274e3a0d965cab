// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/base/hex_text.h"

#include <string_view>

namespace v2vouch {
namespace {

std::string Text(std::span<const std::uint8_t> bytes, std::string_view digits) {
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::uint8_t byte : bytes) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

}  // namespace

std::string HexText(std::span<const std::uint8_t> bytes) { return Text(bytes, "0123456789abcdef"); }
std::string UpperHexText(std::span<const std::uint8_t> bytes) {
  return Text(bytes, "0123456789ABCDEF");
}

}  // namespace v2vouch
