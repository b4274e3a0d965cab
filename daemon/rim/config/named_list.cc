// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/config/named_list.h"

#include <algorithm>
#include <array>
#include <map>

#include "daemon/common/base/did_you_mean.h"

namespace v2vouch::config {
namespace {

// What a sensor cannot do without: where it sits and what it sees. Noise and rates have defaults
// that suit most sensors.
constexpr std::array<NamedList, 4> kNamedLists = {{
    {"vehicle.radars", "name", "x_m y_m yaw_deg half_fov_deg max_range_m"},
    {"vehicle.cameras", "name",
     "x_m y_m z_m yaw_deg image_width_px image_height_px fx_px fy_px cx_px cy_px"},
    {"vehicle.objects", "name", "x_m y_m yaw_deg half_fov_deg max_range_m"},
    {"detector.classes", "id", "class", false},
}};

const YamlNode* ValueOf(const YamlNode& item, std::string_view key) {
  for (std::size_t i = 0; item.type == YamlNode::Type::kMap && i < item.keys.size(); ++i) {
    if (item.keys[i] == key) return &item.items[i];
  }
  return nullptr;
}

// For messages: short, and no control characters on the user's terminal.
std::string Plain(std::string text) {
  constexpr std::size_t kLongest = 60;
  if (text.size() > kLongest) text.replace(kLongest, std::string::npos, "...");
  for (char& c : text) c = static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  return text;
}

// Whether the key is there and true. Another word than true or false is a problem.
bool IsTrue(const YamlNode& item, std::string_view key, std::string& problem) {
  const YamlNode* value = ValueOf(item, key);
  if (value == nullptr || value->text == "false") return false;
  if (value->text != "true") {
    problem = std::string(key) + " = " + Plain(value->text) + ": must be true or false";
  }
  return value->text == "true";
}

// The needed keys that are not there: "x_m, y_m".
std::string Missing(const YamlNode& item, std::string_view needed) {
  std::vector<std::string> missing;
  while (!needed.empty()) {
    const std::string_view key = needed.substr(0, needed.find(' '));
    if (ValueOf(item, key) == nullptr) missing.emplace_back(key);
    needed.remove_prefix(std::min(needed.size(), key.size() + 1));
  }
  return Listed(missing);
}

struct Element {
  std::string name;
  std::string missing;  // Needed keys.
  std::string problem;
  bool adds = false;
  bool removes = false;
};

std::vector<Element> ReadElements(const YamlNode& list, const NamedList& rule,
                                  const std::vector<std::string>& there) {
  std::vector<Element> elements;
  for (const YamlNode& item : list.items) {
    const YamlNode* name = ValueOf(item, rule.name);
    Element& element = elements.emplace_back();
    if (name != nullptr) {
      element.name = Plain(name->text);
    } else if (there.size() == 1 && list.items.size() == 1) {
      element.name = there.front();
    }
    element.missing = Missing(item, rule.needed);
    element.adds = IsTrue(item, "add", element.problem);
    element.removes = IsTrue(item, "remove", element.problem);
  }
  return elements;
}

// What to do with element `i`, which is named once. nullopt with the problem reported.
std::optional<ListPlan::Action> Decide(const Element& element, const YamlNode& item,
                                       const std::vector<std::string>& there, bool keeps_others,
                                       const std::function<void(const std::string&)>& report) {
  using Action = ListPlan::Action;
  const bool is_there = std::ranges::find(there, element.name) != there.end();
  const std::string there_text = there.empty() ? "there is none" : "there are " + Listed(there);
  if (element.removes) {
    if (is_there && item.keys.size() <= 2) return Action::kRemove;
    report(is_there ? "is removed: no other key belongs here"
                    : "there is no " + element.name + " to remove" +
                          DidYouMean(element.name, there) + "; " + there_text);
  } else if (keeps_others && is_there) {
    if (!element.adds) return Action::kAmend;
    report(element.name + " is there already: without `add` its keys are changed");
  } else if (!element.missing.empty()) {
    report("lacks " + element.missing + ": " + element.name + " is new" +
           DidYouMean(element.name, there) + ", and a new one must be complete; " + there_text);
  } else if (keeps_others && !element.adds) {
    report(element.name + " is new and complete, others in this list are not" +
           DidYouMean(element.name, there) + ": say `add: true` to add it to those there are (" +
           Listed(there) + "), or complete all for a list of its own");
  } else {
    return Action::kNew;
  }
  return std::nullopt;
}

}  // namespace

const NamedList* NamedListAt(std::string_view path) {
  const auto is_at = [&](const NamedList& list) {
    return path == list.path || path.ends_with("." + std::string(list.path));
  };
  const auto* const found = std::ranges::find_if(kNamedLists, is_at);
  return found == kNamedLists.end() ? nullptr : found;
}

ListPlan PlanList(const YamlNode& list, const NamedList& rule,
                  const std::vector<std::string>& there, const ListProblem& report) {
  const std::vector<Element> elements = ReadElements(list, rule, there);
  const bool has_parts = std::ranges::any_of(elements, [](const Element& element) {
    return element.adds || (!element.missing.empty() && !element.removes);
  });
  const bool only_removes = !elements.empty() && std::ranges::all_of(elements, &Element::removes);

  ListPlan plan;
  plan.keeps_others = rule.is_merged && (has_parts || only_removes);
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const Element& element = elements[i];
    if (list.items[i].type != YamlNode::Type::kMap) {
      report(i, "must be a section of keys and values");
      continue;
    }
    if (!element.problem.empty()) {
      report(i, element.problem);
      continue;
    }
    if (element.name.empty()) {
      report(i, "has no " + std::string(rule.name));
      continue;
    }
    if (const auto [at, is_new] = first.emplace(element.name, i); !is_new) {
      report(i, element.name + " stands here a second time, first at [" +
                    std::to_string(at->second) + "]");
      continue;
    }
    const auto action = Decide(element, list.items[i], there, plan.keeps_others,
                               [&](const std::string& problem) { report(i, problem); });
    if (action) plan.steps.push_back({*action, i, element.name});
  }
  if (!plan.keeps_others && rule.is_merged && !elements.empty()) {
    for (const std::string& name : there) {
      if (!first.contains(name)) plan.left_out.push_back(name);
    }
  }
  return plan;
}

}  // namespace v2vouch::config
