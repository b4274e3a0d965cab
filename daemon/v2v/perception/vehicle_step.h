// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/local/visibility/visibility.h"
#include "daemon/v2v/perception/v2v_view.h"
#include "daemon/v2v/perception/vehicle_action.h"

namespace v2vouch {

/// What a step changed besides the vehicle itself.
struct VehicleStep {
  VehicleAction action;
  bool is_lost = false;         ///< The sensors have just lost it: its sender bridges it now.
  bool has_reappeared = false;  ///< The sensors support it again.
  bool has_failed_numerics = false;
};

/// One PRIORITY vehicle after an own-sensor frame: takes the measurements that its LOCAL track was
/// given; is bridged once none has come for BridgeConfig::support_s; while bridged it is looked
/// for, and ends when its budget, its accuracy or its sender's silence says so, when the position
/// is seen to be empty (check empty_place), or when the real vehicle is seen elsewhere.
VehicleStep StepVehicle(const V2vView& view, PriorityVehicle& vehicle, const LocalFrame& frame,
                        const VisibilityMap& map);

}  // namespace v2vouch
