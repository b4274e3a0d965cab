// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/rim/config/yaml_node.h"

namespace v2vouch::config {

/// A list of a file whose elements have names, so that one element can be changed without telling
/// all the others again.
struct NamedList {
  std::string_view path;    ///< Key path of the list.
  std::string_view name;    ///< Key that names an element.
  std::string_view needed;  ///< Keys that make an element complete, with spaces between.
  bool is_merged = true;    ///< false: always the whole list, of complete elements.
};

/// The rule of the list at this key path; nullptr: an ordinary list, which replaces its default.
const NamedList* NamedListAt(std::string_view path);

/// What a file's list does to the one that is there already.
struct ListPlan {
  enum class Action { kRemove, kAmend, kNew };
  struct Step {
    Action action = Action::kNew;
    std::size_t item = 0;  ///< Of the file's list.
    std::string name;
  };
  bool keeps_others = false;          ///< false: what is there already goes.
  std::vector<Step> steps;            ///< In the file's order, those without problem.
  std::vector<std::string> left_out;  ///< There already, dropped without a word of the file.
};

/// Called with the index of the element and what is wrong.
using ListProblem = std::function<void(std::size_t item, const std::string& what)>;

/// The rule, for sensors and whatever else has names:
///  - Where every element is complete, the list is the whole list: nothing else stays. An empty
///    list is a whole list too.
///  - Where one is not complete, or has `add: true` or only `remove: true`, the list changes what
///    is there: an element changes the keys it holds of its namesake, `remove: true` takes the
///    namesake away, `add: true` is for a new one, which must be complete; all others stay.
///  - An element without a name is the only one there is. A name twice is a problem.
ListPlan PlanList(const YamlNode& list, const NamedList& rule,
                  const std::vector<std::string>& there, const ListProblem& report);

}  // namespace v2vouch::config
