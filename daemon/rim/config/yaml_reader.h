// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"
#include "daemon/rim/config/named_list.h"
#include "daemon/rim/config/yaml_node.h"

namespace v2vouch::config {

template <class T>
inline constexpr bool kIsVector = false;
template <class T>
inline constexpr bool kIsVector<std::vector<T>> = true;
template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;

/// The archive that fills a config struct from a YAML map through its Visit list (base/visit.h).
/// Strict: unknown, repeated and wrongly typed keys and values out of range are problems, every one
/// of them reported as
///
///     FILE:LINE: key.path = value: must be above 0, at most 10
///
/// A key that is not there keeps its default. A list replaces the default list, and its elements
/// start from the struct's own defaults; lists with names (named_list.h: the sensors) may change
/// single elements instead. An optional is filled where its key is there, starting from its type's
/// own defaults.
class YamlReader {
 public:
  YamlReader(const YamlNode& node, std::string path, const std::string& name,
             std::vector<std::string>& problems, std::vector<std::string>* notes = nullptr);

  template <class T>
  void Field(const char* key, T& value, const Bounds& bounds = {}) {
    if (const YamlNode* node = Find(key)) Read(*node, PathOf(key), value, bounds);
  }

  /// Radians inside, degrees in the file; `bounds` in degrees.
  void Degrees(const char* key, double& radians, const Bounds& bounds = {}) {
    double degrees = 0.0;
    const YamlNode* node = Find(key);
    if (node != nullptr && ReadNumber(*node, PathOf(key), degrees, bounds)) {
      radians = FromDegrees(degrees);
    }
  }

  void Text(const char* key, std::string& value);

  template <class E>
  void Choice(const char* key, E& value,
              std::initializer_list<std::pair<const char*, std::type_identity_t<E>>> choices) {
    const YamlNode* node = Find(key);
    if (node == nullptr) return;
    std::vector<std::string_view> names;
    for (const auto& [name, meaning] : choices) {
      if (node->type == YamlNode::Type::kScalar && node->text == name) {
        value = meaning;
        return;
      }
      names.push_back(name);
    }
    NotAmong(*node, PathOf(key), names);
  }

  /// A key that belongs to another program's settings in the same file.
  void Ignore(const char* key) { Find(key); }

  /// To be called after Visit: reports unknown keys, each with the nearest known one.
  void Finish();

 private:
  const YamlNode* Find(const char* key);
  [[nodiscard]] std::string PathOf(std::string_view key) const;

  template <class T>
  void Read(const YamlNode& node, const std::string& path, T& value, const Bounds& bounds) {
    if constexpr (std::is_same_v<T, bool>) {
      ReadBool(node, path, value);
    } else if constexpr (std::is_same_v<T, double>) {
      ReadNumber(node, path, value, bounds);
    } else if constexpr (std::integral<T>) {
      if (const auto whole = ReadWhole(node, path, bounds, std::numeric_limits<T>::min(),
                                       std::numeric_limits<T>::max())) {
        value = static_cast<T>(*whole);
      }
    } else if constexpr (std::is_same_v<T, std::string>) {
      ReadText(node, path, value);
    } else if constexpr (kIsOptional<T>) {
      Read(node, path, value.emplace(), bounds);
    } else if constexpr (kIsVector<T>) {
      if (!IsList(node, path)) return;
      if (const NamedList* rule = NamedListAt(path)) return ReadNamed(node, path, *rule, value);
      value.clear();
      for (std::size_t i = 0; i < node.items.size(); ++i) {
        Read(node.items[i], path + "[" + std::to_string(i) + "]", value.emplace_back(), bounds);
      }
    } else {
      ReadSection(node, path, value, false);
    }
  }

  template <class T>
  void ReadSection(const YamlNode& node, const std::string& path, T& value, bool is_named) {
    YamlReader reader(node, path, name_, problems_, notes_);
    if (is_named) {
      reader.Ignore("add");
      reader.Ignore("remove");
    }
    value.Visit(reader);
    reader.Finish();
  }

  template <class Item>
  void ReadNamed(const YamlNode& node, const std::string& path, const NamedList& rule,
                 std::vector<Item>& values) {
    if constexpr (std::is_class_v<Item> && !std::is_same_v<Item, std::string>) {
      constexpr bool kHasName = requires(Item item) { std::string(item.name); };
      std::vector<std::string> there;
      if constexpr (kHasName) {
        for (const Item& item : values) there.push_back(item.name);
      }
      const ListPlan plan = Plan(node, path, rule, there);
      if (!plan.keeps_others) values.clear();
      for (const ListPlan::Step& step : plan.steps) {
        Item* item = nullptr;
        if constexpr (kHasName) {
          const auto is_it = [&](const Item& each) { return each.name == step.name; };
          if (step.action == ListPlan::Action::kRemove) {
            std::erase_if(values, is_it);
            continue;
          }
          for (Item& each : values) {
            if (is_it(each)) item = &each;
          }
        }
        if (item == nullptr) item = &values.emplace_back();
        ReadSection(node.items[step.item], path + "[" + std::to_string(step.item) + "]", *item,
                    rule.is_merged);
      }
    }
  }

  void ReadBool(const YamlNode& node, const std::string& path, bool& value);
  bool ReadNumber(const YamlNode& node, const std::string& path, double& value,
                  const Bounds& bounds);
  std::optional<std::int64_t> ReadWhole(const YamlNode& node, const std::string& path,
                                        const Bounds& bounds, std::int64_t lowest,
                                        std::uint64_t highest);
  void ReadText(const YamlNode& node, const std::string& path, std::string& value);
  ListPlan Plan(const YamlNode& node, const std::string& path, const NamedList& rule,
                const std::vector<std::string>& there);
  bool IsList(const YamlNode& node, const std::string& path);
  void NotAmong(const YamlNode& node, const std::string& path,
                const std::vector<std::string_view>& names);
  void Report(const YamlNode& node, const std::string& path, const std::string& what);

  const YamlNode& node_;
  std::string path_;
  const std::string& name_;
  std::vector<std::string>& problems_;
  std::vector<std::string>* notes_;
  std::vector<std::string_view> known_;
};

/// Reads `text` into `settings`. @return false with problems added; what was good is in `settings`.
/// `notes`, where given, takes what is no problem but worth a line.
template <class T>
bool Parse(std::string_view text, const std::string& name, T& settings,
           std::vector<std::string>& problems, std::vector<std::string>* notes = nullptr) {
  const std::size_t before = problems.size();
  const auto root = ParseYaml(text, name, problems);
  if (!root) return false;
  if (root->type != YamlNode::Type::kEmpty) {
    YamlReader reader(*root, "", name, problems, notes);
    settings.Visit(reader);
    reader.Finish();
  }
  return problems.size() == before;
}

/// The same from a file.
template <class T>
bool Load(const std::string& path, T& settings, std::vector<std::string>& problems,
          std::vector<std::string>* notes = nullptr) {
  const auto text = ReadFile(path, problems);
  return text && Parse(*text, path, settings, problems, notes);
}

}  // namespace v2vouch::config
