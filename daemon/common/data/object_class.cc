// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/data/object_class.h"

#include <algorithm>
#include <array>
#include <utility>

namespace v2vouch {
namespace {

constexpr std::array<std::pair<std::string_view, ObjectClass>, 7> kNames = {{
    {"car", ObjectClass::kCar},
    {"van", ObjectClass::kVan},
    {"truck", ObjectClass::kTruck},
    {"bus", ObjectClass::kBus},
    {"motorcycle", ObjectClass::kMotorcycle},
    {"pedestrian", ObjectClass::kPedestrian},
    {"cyclist", ObjectClass::kCyclist},
}};

}  // namespace

std::string_view ObjectClassName(ObjectClass object_class) {
  const auto found = std::find_if(kNames.begin(), kNames.end(),
                                  [&](const auto& entry) { return entry.second == object_class; });
  return found == kNames.end() ? std::string_view() : found->first;
}

std::optional<ObjectClass> ObjectClassOf(std::string_view name) {
  const auto found = std::find_if(kNames.begin(), kNames.end(),
                                  [&](const auto& entry) { return entry.first == name; });
  return found == kNames.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace v2vouch
