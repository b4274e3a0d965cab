// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "daemon/common/base/visit.h"
#include "daemon/rim/config/yaml_reader.h"

namespace v2vouch::config {

/// The archive that prints a config struct as YAML through its Visit list. What it prints reads
/// back as the same values, bit for bit.
class YamlWriter {
 public:
  template <class T>
  void Field(const char* key, T& value, const Bounds& = {}) {
    if constexpr (kIsOptional<T>) {
      if (value) Field(key, *value);
    } else if constexpr (std::is_same_v<T, bool>) {
      Line(key, value ? "true" : "false");
    } else if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::string>) {
      Line(key, Scalar(value));
    } else if constexpr (std::integral<T>) {
      Line(key, std::to_string(value));
    } else if constexpr (kIsVector<T>) {
      List(key, value);
    } else {
      Line(key, "");
      indent_ += 2;
      value.Visit(*this);
      indent_ -= 2;
    }
  }

  void Degrees(const char* key, double& radians, const Bounds& = {});
  void Text(const char* key, std::string& value) { Line(key, Scalar(value)); }

  template <class E>
  void Choice(const char* key, E& value,
              std::initializer_list<std::pair<const char*, std::type_identity_t<E>>> choices) {
    for (const auto& [name, meaning] : choices) {
      if (value == meaning) return Line(key, name);
    }
  }

  void Ignore(const char*) {}

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  template <class T>
  void List(const char* key, std::vector<T>& values) {
    if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::string> || std::integral<T>) {
      std::string items;
      for (const T& value : values) items += (items.empty() ? "" : ", ") + Scalar(value);
      Line(key, "[" + items + "]");
    } else {
      if (values.empty()) return Line(key, "[]");
      Line(key, "");
      for (T& value : values) {
        indent_ += 4;
        begins_item_ = true;
        value.Visit(*this);
        indent_ -= 4;
      }
    }
  }

  void Line(std::string_view key, std::string_view value);
  static std::string Scalar(double value);
  static std::string Scalar(const std::string& value);
  static std::string Scalar(std::integral auto value) { return std::to_string(value); }

  std::string text_;
  std::size_t indent_ = 0;
  bool begins_item_ = false;
};

/// `settings` as YAML: the effective configuration.
template <class T>
std::string Print(T settings) {
  YamlWriter writer;
  settings.Visit(writer);
  return writer.text();
}

}  // namespace v2vouch::config
