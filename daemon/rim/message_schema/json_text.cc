// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/message_schema/json_text.h"

#include <array>
#include <charconv>
#include <cmath>

#include "daemon/rim/message_schema/walk.h"

namespace v2vouch::message_schema {
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

class JsonWriter : public Visitor {
 public:
  void BeginStruct(const Type&) override {
    Separate();
    json += '{';
    is_first_ = true;
  }
  void EndStruct() override { Close('}'); }
  void Name(const Field& field) override {
    Separate();
    json += '"';
    json += field.name;  // A name of C.
    json += "\":";
    is_first_ = true;
  }
  void BeginArray(std::size_t) override {
    Separate();
    json += '[';
    is_first_ = true;
  }
  void EndArray() override { Close(']'); }
  void Integer(std::int64_t value) override {
    Separate();
    std::array<char, 24> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    json.append(digits.data(), end);
  }
  void Boolean(bool value) override {
    Separate();
    json += value ? "true" : "false";
  }
  void Real(double value) override {
    Separate();
    AppendJsonNumber(json, value);
  }
  void Text(std::string_view value) override {
    Separate();
    AppendJsonString(json, value);
  }
  void Bytes(std::span<const std::uint8_t> value, bool is_fixed) override {
    Separate();
    json += '"';
    if (is_fixed) {
      for (const std::uint8_t octet : value) {
        json += kHex[octet >> 4U];
        json += kHex[octet & 15U];
      }
    } else {
      AppendBase64(json, value);
    }
    json += '"';
  }

  std::string json;

 private:
  void Separate() {
    if (!is_first_) json += ',';
    is_first_ = false;
  }
  void Close(char bracket) {
    json += bracket;
    is_first_ = false;
  }
  bool is_first_ = true;  // No comma in front of the next one.
};

}  // namespace

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

std::optional<std::string> JsonText(const Type& type, std::span<const std::uint8_t> message) {
  JsonWriter writer;
  writer.json.reserve(3 * message.size());
  if (!Walk(type, message, writer)) return std::nullopt;
  return std::move(writer.json);
}

}  // namespace v2vouch::message_schema
