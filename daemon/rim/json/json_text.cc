// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/json/json_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace v2vouch {
namespace {

constexpr char kHex[] = "0123456789abcdef";

// Bytes of the UTF-8 character at the front of `text`; 0 where there is none.
std::size_t CharacterBytes(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t lead = at(0);
  if (lead < 0x80) return 1;
  const std::size_t size = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i) {
    if ((at(i) & 0xC0U) != 0x80) return 0;
  }
  // Longer than needed, halves of a UTF-16 pair, beyond the last character.
  if (lead == 0xE0 && at(1) < 0xA0) return 0;
  if (lead == 0xED && at(1) > 0x9F) return 0;
  if (lead == 0xF0 && at(1) < 0x90) return 0;
  if (lead == 0xF4 && at(1) > 0x8F) return 0;
  return size;
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
  AppendJsonString(text_, text);
  return *this;
}

JsonText& JsonText::Raw(std::string_view json) {
  Separate();
  text_ += json;
  return *this;
}

bool IsUtf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t size = CharacterBytes(text);
    if (size == 0) return false;
    text.remove_prefix(size);
  }
  return true;
}

void AppendJsonString(std::string& json, std::string_view text) {
  json += '"';
  while (!text.empty()) {
    const std::size_t size = CharacterBytes(text);
    const char c = text.front();
    const auto octet = static_cast<std::uint8_t>(c);
    if (size == 0) {
      json += "\xEF\xBF\xBD";
    } else if (size > 1) {
      json += text.substr(0, size);
    } else if (c == '"' || c == '\\') {
      json += '\\';
      json += c;
    } else if (octet < 0x20 || octet == 0x7F) {
      json += "\\u00";
      json += kHex[octet >> 4U];
      json += kHex[octet & 15U];
    } else {
      json += c;
    }
    text.remove_prefix(size == 0 ? 1 : size);
  }
  json += '"';
}

void AppendJsonNumber(std::string& json, double value) {
  if (!std::isfinite(value)) {
    json += "null";
    return;
  }
  std::array<char, 40> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  json.append(digits.data(), end);
}

void AppendBase64(std::string& json, std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  json.reserve(json.size() + (bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = (bits << 8U) | (k < have ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      json += k <= have ? kDigits[(bits >> (18 - 6 * k)) & 63U] : '=';
    }
  }
}

std::string Base64(std::span<const std::uint8_t> bytes) {
  std::string text;
  AppendBase64(text, bytes);
  return text;
}

}  // namespace v2vouch
