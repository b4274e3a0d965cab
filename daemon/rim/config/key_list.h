// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "daemon/common/base/visit.h"
#include "daemon/rim/config/bounds_text.h"
#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/config/yaml_writer.h"

namespace v2vouch::config {

/// One key of a configuration struct.
struct Key {
  std::string path;   ///< "tracking.motion.accel_psd"; an item of a list: "vehicle.radars[].x_m".
  std::string range;  ///< "must be above 0, at most 10"; the choices; "" = anything.
  std::string value;  ///< As the file would spell it.
};

/// The archive that lists the keys of a config struct through its Visit list, for the reference
/// page. Of a list of structs the first item stands for all.
class KeyLister {
 public:
  template <class T>
  void Field(const char* key, T& value, const Bounds& bounds = {}) {
    if constexpr (kIsOptional<T>) {
      if (value) {
        Field(key, *value, bounds);
      } else {
        Add(key, BoundsText(bounds), "");
      }
    } else if constexpr (kIsVector<T>) {
      List(key, value);
    } else if constexpr (std::is_same_v<T, bool>) {
      Add(key, "true or false", value ? "true" : "false");
    } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
      Add(key, BoundsText(bounds), Spelled(value));
    } else {
      Enter(key, value);
    }
  }
  void Degrees(const char* key, double& radians, const Bounds& bounds = {}) {
    YamlWriter writer;
    writer.Degrees(key, radians);
    Add(key, BoundsText(bounds), AfterColon(writer.text()));
  }
  void Text(const char* key, std::string& value) { Add(key, "", Spelled(value)); }

  template <class E>
  void Choice(const char* key, E& value,
              std::initializer_list<std::pair<const char*, std::type_identity_t<E>>> choices) {
    std::string range;
    std::string chosen;
    for (const auto& [name, meaning] : choices) {
      range += (range.empty() ? "" : ", ") + std::string(name);
      if (value == meaning) chosen = name;
    }
    Add(key, range, chosen);
  }
  void Ignore(const char*) {}

  [[nodiscard]] std::vector<Key>& keys() { return keys_; }

 private:
  template <class T>
  void Enter(std::string_view key, T& value) {
    const std::string outer = prefix_;
    prefix_ += std::string(key) + ".";
    value.Visit(*this);
    prefix_ = outer;
  }
  template <class T>
  void List(const char* key, std::vector<T>& values) {
    if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
      Add(key, "list", Spelled(values));
    } else {
      T first{};
      Enter(std::string(key) + "[]", values.empty() ? first : values.front());
    }
  }
  // As the YAML file spells it.
  template <class T>
  static std::string Spelled(T& value) {
    YamlWriter writer;
    writer.Field("key", value);
    return AfterColon(writer.text());
  }
  static std::string AfterColon(const std::string& line);
  void Add(std::string_view key, std::string range, std::string value) {
    keys_.push_back({prefix_ + std::string(key), std::move(range), std::move(value)});
  }

  std::string prefix_;
  std::vector<Key> keys_;
};

template <class T>
std::vector<Key> KeysOf(T settings) {
  KeyLister lister;
  settings.Visit(lister);
  return std::move(lister.keys());
}

}  // namespace v2vouch::config
