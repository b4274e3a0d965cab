// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/config/yaml_writer.h"

#include <algorithm>
#include <cctype>

#include "daemon/rim/config/number_text.h"

namespace v2vouch::config {
namespace {

bool IsPlainWord(const std::string& text) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '/' || c == '.' || c == '-';
  };
  return !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])) != 0 &&
         std::all_of(text.begin(), text.end(), is_plain) && text != "true" && text != "false" &&
         text != "null";
}

}  // namespace

void YamlWriter::Line(std::string_view key, std::string_view value) {
  text_.append(indent_, ' ');
  if (begins_item_) text_[text_.size() - 2] = '-';
  begins_item_ = false;
  text_ += key;
  text_ += ':';
  if (!value.empty()) text_ += ' ';
  text_ += value;
  text_ += '\n';
}

void YamlWriter::Degrees(const char* key, double& radians, const Bounds&) {
  Line(key, DegreesText(radians));
}

std::string YamlWriter::Scalar(double value) { return NumberText(value); }

std::string YamlWriter::Scalar(const std::string& value) {
  if (IsPlainWord(value)) return value;
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string quoted = "\"";
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (byte < 0x20 || byte == 0x7F) {
      quoted += "\\x";
      quoted += kHex[byte >> 4];
      quoted += kHex[byte & 15];
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

}  // namespace v2vouch::config
