// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/access.h"

#include <algorithm>
#include <charconv>

namespace v2vouch::view {
namespace {

constexpr std::string_view kTokenProtocol = "v2vouch.token.";

std::string Lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

// Four decimal numbers with single dots, nothing else, the first of them 127.
bool IsLoopback4(std::string_view text) {
  for (int part = 0; part < 4; ++part) {
    unsigned value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const auto length = static_cast<std::size_t>(end - text.data());
    if (error != std::errc{} || length > 3 || value > 255) return false;
    if (length > 1 && text.front() == '0') return false;  // Some read that as octal.
    if (part == 0 && value != 127) return false;
    text.remove_prefix(length);
    if (part == 3) return text.empty();
    if (!text.starts_with('.')) return false;
    text.remove_prefix(1);
  }
  return false;
}

// Equal in a time that does not tell how much of it is.
bool IsSameSecret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = static_cast<unsigned char>(difference | (a[i] ^ b[i]));
  }
  return difference == 0;
}

// Calls `each` with every comma-separated word.
template <class Each>
void ForWords(std::string_view list, Each each) {
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    std::string_view word = list.substr(0, comma);
    while (word.starts_with(' ')) word.remove_prefix(1);
    while (word.ends_with(' ')) word.remove_suffix(1);
    each(word);
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
}

}  // namespace

bool IsHostAllowed(const AccessRules& rules, std::string_view host) {
  const std::string suffix = ":" + std::to_string(rules.port);
  const std::string lower = Lower(host);
  std::string_view name = lower;
  if (name.ends_with(suffix)) {
    name.remove_suffix(suffix.size());
  } else if (rules.port != 80) {  // The one port that browsers leave out.
    return false;
  }
  if (name == "localhost" || name == "[::1]" || IsLoopback4(name)) return true;
  return std::ranges::any_of(rules.hosts,
                             [&](const std::string& allowed) { return Lower(allowed) == name; });
}

bool IsOriginAllowed(const AccessRules& rules, std::string_view host, std::string_view origin) {
  if (origin.empty() || Lower(origin) == "http://" + Lower(host)) return true;
  return std::ranges::any_of(
      rules.origins, [&](const std::string& allowed) { return Lower(allowed) == Lower(origin); });
}

bool HasToken(const AccessRules& rules, std::string_view target, std::string_view protocols) {
  if (rules.token.empty()) return true;
  bool has_token = false;
  ForWords(protocols, [&](std::string_view word) {
    if (!word.starts_with(kTokenProtocol)) return;
    has_token |= IsSameSecret(word.substr(kTokenProtocol.size()), rules.token);
  });
  const std::size_t query = target.find('?');
  if (query == std::string_view::npos) return has_token;
  std::string_view pairs = target.substr(query + 1);
  while (!pairs.empty()) {
    const std::size_t end = std::min(pairs.find('&'), pairs.size());
    const std::string_view pair = pairs.substr(0, end);
    if (pair.starts_with("t=")) has_token |= IsSameSecret(pair.substr(2), rules.token);
    pairs.remove_prefix(std::min(end + 1, pairs.size()));
  }
  return has_token;
}

std::optional<std::string> ChooseProtocol(std::string_view offered) {
  for (const std::string_view ours : {kPageProtocol, std::string_view("foxglove.sdk.v1"),
                                      std::string_view("foxglove.websocket.v1")}) {
    bool is_offered = false;
    ForWords(offered, [&](std::string_view word) { is_offered |= word == ours; });
    if (is_offered) return std::string(ours);
  }
  return std::nullopt;
}

}  // namespace v2vouch::view
