// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// The section `vehicle` of a vehicle file alone, for programs that need no other. Read strictly,
/// a file with other sections is refused.
struct VehicleSection {
  VehicleConfig vehicle;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("vehicle", vehicle);
  }
};

}  // namespace v2vouch
