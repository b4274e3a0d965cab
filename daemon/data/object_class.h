// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "daemon/data/input.h"

namespace v2vouch {

/// The name that travels in camera_box_t and in scenario files: car, van, truck, bus, motorcycle,
/// pedestrian, cyclist; "" for kUnknown.
std::string_view ObjectClassName(ObjectClass object_class);

/// The inverse; nullopt for any other text.
std::optional<ObjectClass> ObjectClassOf(std::string_view name);

}  // namespace v2vouch
