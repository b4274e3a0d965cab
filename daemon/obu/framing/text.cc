// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/framing/text.h"

#include "daemon/obu/octets/hex_text.h"

namespace v2vouch::obu {
namespace {

bool EqualsIgnoringCase(std::string_view text, std::string_view lower) {
  if (text.size() != lower.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    const char small = letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter + 32) : letter;
    if (small != lower[i]) return false;
  }
  return true;
}

}  // namespace

std::optional<std::string_view> PayloadOfRsuText(std::string_view text) {
  bool has_version = false;
  std::optional<std::string_view> payload;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) continue;
    const std::string_view key = Trimmed(line.substr(0, equals));
    if (EqualsIgnoringCase(key, "version")) has_version = true;
    if (EqualsIgnoringCase(key, "payload")) payload = Trimmed(line.substr(equals + 1));
  }
  return has_version ? payload : std::nullopt;
}

}  // namespace v2vouch::obu
