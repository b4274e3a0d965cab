// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "daemon/common/data/input.h"

namespace v2vouch {

/// The name that travels in camera_box_t and in scenario files: car, van, truck, bus, motorcycle,
/// pedestrian, cyclist; "" for kUnknown.
std::string_view ObjectClassName(ObjectClass object_class);

/// The inverse; nullopt for any other text.
std::optional<ObjectClass> ObjectClassOf(std::string_view name);

/// The key `class` of a config struct (base/visit.h), with the same names.
template <class Archive>
void VisitObjectClass(Archive& a, ObjectClass& value) {
  a.Choice("class", value,
           {{"car", ObjectClass::kCar},
            {"van", ObjectClass::kVan},
            {"truck", ObjectClass::kTruck},
            {"bus", ObjectClass::kBus},
            {"motorcycle", ObjectClass::kMotorcycle},
            {"pedestrian", ObjectClass::kPedestrian},
            {"cyclist", ObjectClass::kCyclist}});
}

}  // namespace v2vouch
