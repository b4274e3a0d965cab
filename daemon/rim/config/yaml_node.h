// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace v2vouch::config {

/// One value of a YAML file as it stands there: nothing is interpreted, repeated keys are kept.
struct YamlNode {
  enum class Type { kEmpty, kScalar, kList, kMap };

  Type type = Type::kEmpty;
  std::string text;               ///< Of a scalar.
  bool is_quoted = false;         ///< "1.0" in quotes is a text, not a number.
  int line = 0;                   ///< From 1.
  std::vector<std::string> keys;  ///< Of a map, beside `items`.
  std::vector<YamlNode> items;
};

inline constexpr std::size_t kMaxFileBytes = 4u << 20;
inline constexpr int kMaxDepth = 24;

/// Parses one YAML document with bounded size and depth. Anchors, aliases and tags are refused: a
/// few bytes of them can mean gigabytes.
/// @param name stands in front of problems, e.g. the file's path.
/// @return nullopt with one more problem when the text is not YAML we take.
std::optional<YamlNode> ParseYaml(std::string_view text, const std::string& name,
                                  std::vector<std::string>& problems);

/// The content of a file of at most kMaxFileBytes.
std::optional<std::string> ReadFile(const std::string& path, std::vector<std::string>& problems);

}  // namespace v2vouch::config
