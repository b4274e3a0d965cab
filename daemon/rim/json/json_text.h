// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace v2vouch {

/// Writes JSON from left to right into one string. Numbers have a fixed number of decimals,
/// trailing zeros left out, and what is not finite is null. Texts may be hostile: each odd byte
/// becomes U+FFFD, so that the result is always valid.
class JsonText {
 public:
  JsonText& Open(char bracket);  ///< '{' or '['.
  JsonText& Close(char bracket);
  JsonText& Key(std::string_view name);  ///< One of ours: not escaped.
  JsonText& Number(double value, int decimals = 3);
  JsonText& Integer(std::int64_t value);
  JsonText& Bool(bool value);
  JsonText& Text(std::string_view text);
  JsonText& Raw(std::string_view json);  ///< A value that is JSON already.

  JsonText& Number(std::string_view key, double value, int decimals = 3) {
    return Key(key).Number(value, decimals);
  }
  JsonText& Integer(std::string_view key, std::int64_t value) { return Key(key).Integer(value); }
  JsonText& Bool(std::string_view key, bool value) { return Key(key).Bool(value); }
  JsonText& Text(std::string_view key, std::string_view text) { return Key(key).Text(text); }

  [[nodiscard]] const std::string& text() const { return text_; }
  std::string Take() { return std::move(text_); }

 private:
  void Separate();
  std::string text_;
  bool needs_comma_ = false;
};

/// Building blocks of it, for other JSON written by hand.
void AppendJsonString(std::string& json, std::string_view text);
void AppendJsonNumber(std::string& json, double value);  ///< Shortest exact form, or null.
void AppendBase64(std::string& json, std::span<const std::uint8_t> bytes);
std::string Base64(std::span<const std::uint8_t> bytes);  ///< RFC 4648, with padding.
bool IsUtf8(std::string_view text);

}  // namespace v2vouch
