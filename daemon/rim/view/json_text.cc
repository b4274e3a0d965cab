// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/json_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace v2vouch::view {
namespace {

constexpr std::string_view kHex = "0123456789abcdef";

// Length of the UTF-8 character that `text` begins with; 0 where it is none.
std::size_t CharacterLength(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const auto continues = [&](std::size_t i) { return i < text.size() && (at(i) & 0xC0) == 0x80; };
  if (at(0) < 0x80) return 1;
  if (at(0) >= 0xC2 && at(0) < 0xE0) return continues(1) ? 2 : 0;
  if (at(0) >= 0xE0 && at(0) < 0xF0) {
    if (!continues(1) || !continues(2)) return 0;
    if (at(0) == 0xE0 && at(1) < 0xA0) return 0;   // Longer than needed.
    if (at(0) == 0xED && at(1) >= 0xA0) return 0;  // Half of a surrogate pair.
    return 3;
  }
  if (at(0) >= 0xF0 && at(0) < 0xF5) {
    if (!continues(1) || !continues(2) || !continues(3)) return 0;
    if (at(0) == 0xF0 && at(1) < 0x90) return 0;
    if (at(0) == 0xF4 && at(1) >= 0x90) return 0;  // Above U+10FFFF.
    return 4;
  }
  return 0;
}

}  // namespace

void JsonText::Separate() {
  if (needs_comma_) text_ += ',';
  needs_comma_ = true;
}

JsonText& JsonText::Open(char bracket) {
  Separate();
  text_ += bracket;
  needs_comma_ = false;
  return *this;
}

JsonText& JsonText::Close(char bracket) {
  text_ += bracket;
  needs_comma_ = true;
  return *this;
}

JsonText& JsonText::Key(std::string_view name) {
  Separate();
  text_ += '"';
  text_ += name;
  text_ += "\":";
  needs_comma_ = false;
  return *this;
}

JsonText& JsonText::Number(double value, int decimals) {
  Separate();
  std::array<char, 64> buffer{};
  constexpr double kLargest = 1e15;  // Beyond, a double has no decimals.
  if (!std::isfinite(value)) {
    text_ += "null";
    return *this;
  }
  const bool is_large = std::abs(value) > kLargest;
  const auto result = is_large ? std::to_chars(buffer.begin(), buffer.end(), value)
                               : std::to_chars(buffer.begin(), buffer.end(), value,
                                               std::chars_format::fixed, decimals);
  std::string_view digits(buffer.data(), static_cast<std::size_t>(result.ptr - buffer.data()));
  if (!is_large && decimals > 0) {
    while (digits.ends_with('0')) digits.remove_suffix(1);
    if (digits.ends_with('.')) digits.remove_suffix(1);
  }
  text_ += digits == "-0" ? "0" : digits;
  return *this;
}

JsonText& JsonText::Integer(std::int64_t value) {
  Separate();
  text_ += std::to_string(value);
  return *this;
}

JsonText& JsonText::Bool(bool value) {
  Separate();
  text_ += value ? "true" : "false";
  return *this;
}

JsonText& JsonText::Text(std::string_view text) {
  Separate();
  text_ += '"';
  while (!text.empty()) {
    const std::size_t length = CharacterLength(text);
    const char first = text.front();
    if (length == 0) {
      text_ += '?';
    } else if (first == '"' || first == '\\') {
      text_ += '\\';
      text_ += first;
    } else if (static_cast<unsigned char>(first) < 0x20) {
      text_ += "\\u00";
      text_ += kHex[static_cast<std::size_t>(first >> 4)];
      text_ += kHex[static_cast<std::size_t>(first & 15)];
    } else {
      text_ += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  text_ += '"';
  return *this;
}

JsonText& JsonText::Raw(std::string_view json) {
  Separate();
  text_ += json;
  return *this;
}

std::string Base64(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t left = size - i;
    std::uint32_t group = static_cast<std::uint32_t>(bytes[i]) << 16;
    if (left > 1) group |= static_cast<std::uint32_t>(bytes[i + 1]) << 8;
    if (left > 2) group |= bytes[i + 2];
    out += kDigits[group >> 18];
    out += kDigits[(group >> 12) & 63];
    out += left > 1 ? kDigits[(group >> 6) & 63] : '=';
    out += left > 2 ? kDigits[group & 63] : '=';
  }
  return out;
}

std::string SenderName(std::uint32_t sender) {
  std::string out(8, '0');
  for (std::size_t i = 0; i < 8; ++i) out[i] = kHex[(sender >> (28 - 4 * i)) & 15];
  return out;
}

}  // namespace v2vouch::view
