// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/world/scenario.h"
#include "sim/world/trajectory.h"

namespace v2vouch::sim {

/// A vehicle as it never changes.
struct Actor {
  std::uint32_t id = 0;
  ObjectClass object_class = ObjectClass::kCar;
  Size size;
  bool has_v2v = false;
  SenderSpec sender;
  DriveSpec drive;  ///< Empty route: parked or recorded.
  Trajectory trajectory;
};

/// The vehicle of a spec on its way along `path`.
Actor MakeDriven(const VehicleSpec& spec, const Path& path, double duration_s);

}  // namespace v2vouch::sim
