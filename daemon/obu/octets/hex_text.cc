// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/octets/hex_text.h"

namespace v2vouch::obu {
namespace {

int DigitOf(char letter) {
  if (letter >= '0' && letter <= '9') return letter - '0';
  if (letter >= 'a' && letter <= 'f') return letter - 'a' + 10;
  if (letter >= 'A' && letter <= 'F') return letter - 'A' + 10;
  return -1;
}

bool IsBlank(char letter) {
  return letter == ' ' || letter == '\t' || letter == '\r' || letter == '\n';
}

}  // namespace

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && IsBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsBlank(text.back())) text.remove_suffix(1);
  return text;
}

Fault ReadHex(std::string_view text, std::span<std::uint8_t> scratch, Bytes& bytes) {
  text = Trimmed(text);
  if (text.starts_with("0x") || text.starts_with("0X")) text.remove_prefix(2);
  if (text.empty()) return {FaultKind::kEmpty, "hex"};
  std::size_t size = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (IsBlank(text[i])) continue;
    const int high = DigitOf(text[i]);
    if (high < 0) return {FaultKind::kBadText, "not a hex digit"};
    if (i + 1 >= text.size() || IsBlank(text[i + 1])) {
      return {FaultKind::kBadText, "odd number of hex digits"};
    }
    const int low = DigitOf(text[++i]);
    if (low < 0) return {FaultKind::kBadText, "not a hex digit"};
    if (size == scratch.size()) {
      return {FaultKind::kTooLong, "datagram", static_cast<std::int64_t>(scratch.size() + 1)};
    }
    scratch[size++] = static_cast<std::uint8_t>(high * 16 + low);
  }
  bytes = Bytes(scratch.data(), size);
  return {};
}

}  // namespace v2vouch::obu
