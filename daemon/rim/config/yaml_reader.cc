// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/config/yaml_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/rim/config/bounds_text.h"

namespace v2vouch::config {
namespace {

// For messages: short, and no control characters on the user's terminal.
std::string Shown(const YamlNode& node) {
  switch (node.type) {
    case YamlNode::Type::kEmpty:
      return "nothing";
    case YamlNode::Type::kList:
      return "a list";
    case YamlNode::Type::kMap:
      return "a section";
    case YamlNode::Type::kScalar:
      break;
  }
  std::string text = node.text.substr(0, 60);
  for (char& c : text) c = static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  if (text.size() < node.text.size()) text += "...";
  return node.is_quoted ? "\"" + text + "\"" : text;
}

template <class T>
std::optional<T> ParseWhole(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

YamlReader::YamlReader(const YamlNode& node, std::string path, const std::string& name,
                       std::vector<std::string>& problems, std::vector<std::string>* notes)
    : node_(node), path_(std::move(path)), name_(name), problems_(problems), notes_(notes) {
  if (node.type != YamlNode::Type::kMap)
    Report(node, path_, "must be a section of keys and values");
}

const YamlNode* YamlReader::Find(const char* key) {
  known_.push_back(key);
  if (node_.type != YamlNode::Type::kMap) return nullptr;
  const YamlNode* found = nullptr;
  for (std::size_t i = 0; i < node_.keys.size(); ++i) {
    if (node_.keys[i] != key) continue;
    if (found != nullptr) {
      Report(node_.items[i], PathOf(key),
             "stands here a second time, first in line " + std::to_string(found->line));
    } else {
      found = &node_.items[i];
    }
  }
  return found;
}

std::string YamlReader::PathOf(std::string_view key) const {
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

void YamlReader::Finish() {
  for (std::size_t i = 0; node_.type == YamlNode::Type::kMap && i < node_.keys.size(); ++i) {
    const std::string& key = node_.keys[i];
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    YamlNode as_value;
    as_value.type = YamlNode::Type::kScalar;
    as_value.text = key;
    problems_.push_back(name_ + ":" + std::to_string(node_.items[i].line) + ": " +
                        PathOf(Shown(as_value)) + ": unknown key" + DidYouMean(key, known_));
  }
}

void YamlReader::Text(const char* key, std::string& value) {
  if (const YamlNode* node = Find(key)) ReadText(*node, PathOf(key), value);
}

void YamlReader::ReadText(const YamlNode& node, const std::string& path, std::string& value) {
  if (node.type == YamlNode::Type::kScalar) {
    value = node.text;
  } else {
    Report(node, path, "must be a text");
  }
}

void YamlReader::ReadBool(const YamlNode& node, const std::string& path, bool& value) {
  const bool is_plain = node.type == YamlNode::Type::kScalar && !node.is_quoted;
  if (is_plain && node.text == "true") {
    value = true;
  } else if (is_plain && node.text == "false") {
    value = false;
  } else {
    Report(node, path, "must be true or false");
  }
}

bool YamlReader::ReadNumber(const YamlNode& node, const std::string& path, double& value,
                            const Bounds& bounds) {
  double number = 0.0;
  bool is_number = node.type == YamlNode::Type::kScalar && !node.is_quoted;
  if (is_number) {
    std::string_view text = node.text;
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    is_number = error == std::errc{} && end == text.data() + text.size() && std::isfinite(number);
  }
  if (!is_number) {
    const std::string words = BoundsText(bounds);
    Report(node, path, words.empty() ? "must be a number" : words + " (a number)");
    return false;
  }
  if (!AreKept(bounds, number)) {
    Report(node, path, BoundsText(bounds));
    return false;
  }
  value = number;
  return true;
}

std::optional<std::int64_t> YamlReader::ReadWhole(const YamlNode& node, const std::string& path,
                                                  const Bounds& bounds, std::int64_t lowest,
                                                  std::uint64_t highest) {
  std::optional<std::int64_t> whole;
  if (node.type == YamlNode::Type::kScalar && !node.is_quoted) {
    whole = ParseWhole<std::int64_t>(node.text);
    if (const auto large = ParseWhole<std::uint64_t>(node.text); !whole && large) {
      whole = static_cast<std::int64_t>(*large);  // Only an uint64 can hold it; checked below.
      if (*large > highest) whole.reset();
    } else if (whole &&
               (*whole < lowest || (*whole > 0 && static_cast<std::uint64_t>(*whole) > highest))) {
      whole.reset();
    }
  }
  if (!whole) {
    const std::string words = BoundsText(bounds);
    Report(node, path, words.empty() ? "must be a whole number" : words + " (a whole number)");
    return std::nullopt;
  }
  const double number = *whole < 0 && lowest >= 0
                            ? static_cast<double>(static_cast<std::uint64_t>(*whole))
                            : static_cast<double>(*whole);
  if (!AreKept(bounds, number)) {
    Report(node, path, BoundsText(bounds));
    return std::nullopt;
  }
  return whole;
}

bool YamlReader::IsList(const YamlNode& node, const std::string& path) {
  if (node.type == YamlNode::Type::kList) return true;
  Report(node, path, "must be a list");
  return false;
}

ListPlan YamlReader::Plan(const YamlNode& node, const std::string& path, const NamedList& rule,
                          const std::vector<std::string>& there) {
  ListPlan plan = PlanList(node, rule, there, [&](std::size_t item, const std::string& what) {
    problems_.push_back(name_ + ":" + std::to_string(node.items[item].line) + ": " + path + "[" +
                        std::to_string(item) + "]: " + what);
  });
  if (notes_ != nullptr && !plan.left_out.empty()) {
    notes_->push_back(name_ + ":" + std::to_string(node.line) + ": " + path + " is a whole list: " +
                      Listed(plan.left_out) + (plan.left_out.size() == 1 ? " is" : " are") +
                      " not part of it ({name: " + plan.left_out.front() +
                      ", remove: true} says so; `add: true` in a new one keeps the others)");
  }
  return plan;
}

void YamlReader::NotAmong(const YamlNode& node, const std::string& path,
                          const std::vector<std::string_view>& names) {
  std::string words = "must be one of";
  for (std::size_t i = 0; i < names.size(); ++i) {
    words += (i == 0 ? " " : ", ") + std::string(names[i]);
  }
  if (node.type == YamlNode::Type::kScalar) words += DidYouMean(node.text, names);
  Report(node, path, words);
}

void YamlReader::Report(const YamlNode& node, const std::string& path, const std::string& what) {
  problems_.push_back(name_ + ":" + std::to_string(node.line) + ": " +
                      (path.empty() ? "the file" : path) + " = " + Shown(node) + ": " + what);
}

}  // namespace v2vouch::config
