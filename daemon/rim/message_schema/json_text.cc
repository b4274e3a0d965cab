// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/message_schema/json_text.h"

#include <array>
#include <charconv>

#include "daemon/rim/json/json_text.h"
#include "daemon/rim/message_schema/walk.h"

namespace v2vouch::message_schema {
namespace {

constexpr char kHex[] = "0123456789abcdef";

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

std::optional<std::string> JsonText(const Type& type, std::span<const std::uint8_t> message) {
  JsonWriter writer;
  writer.json.reserve(3 * message.size());
  if (!Walk(type, message, writer)) return std::nullopt;
  return std::move(writer.json);
}

}  // namespace v2vouch::message_schema
