// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "daemon/common/data/input.h"

namespace v2vouch::wire {

/// What the name that a detector gave its box means.
struct NamedClass {
  ObjectClass object_class = ObjectClass::kUnknown;
  bool is_known = false;     ///< The name is one of ours, or says that the class is open.
  bool is_road_user = true;  ///< false: a traffic light, an animal; a box of no vehicle.
  friend bool operator==(const NamedClass&, const NamedClass&) = default;
};

/// Names as detectors and data sets use them, in upper or lower case, with any separators: COCO,
/// KITTI ("Person_sitting"), nuScenes ("vehicle.bus.bendy"), Waymo ("TYPE_CYCLIST"), BDD100K,
/// Cityscapes, SUMO, Autoware, some German ones. The first word that means something counts; a
/// decimal number is a class of COCO's eighty, counted from 0 as YOLO networks do. "", "vehicle",
/// "unknown" and the like leave the class open.
NamedClass MeaningOf(std::string_view name);

/// The class alone.
inline ObjectClass ClassOfName(std::string_view name) { return MeaningOf(name).object_class; }

/// A name as it may stand in a log: at most 32 characters, odd ones replaced by '?'.
std::string Printable(std::string_view name);

}  // namespace v2vouch::wire
