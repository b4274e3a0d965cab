// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/data/claim.h"
#include "daemon/v2v/perception/priority_config.h"
#include "daemon/v2v/perception/vehicle_action.h"
#include "daemon/v2v/priority/priority_vehicle.h"
#include "daemon/v2v/senders/sender_record.h"

namespace v2vouch {

/// A validated sender's claim moves its PRIORITY vehicle: position, speed and heading, each with
/// its error state. Of a hidden vehicle it must fit what is carried, and stay in reach of where the
/// sensors lost it.
VehicleAction UseClaim(const SenderRecord& record, PriorityVehicle& vehicle,
                       const ClaimInOdometry& here, const PriorityConfig& config);

/// A sender that reports poor accuracy: use speed and heading, ignore the position. The sensors
/// alone place the vehicle meanwhile, and while it is hidden it goes on as the sender says.
VehicleAction UseMotion(const SenderRecord& record, PriorityVehicle& vehicle,
                        const ClaimInOdometry& here, const PriorityConfig& config);

}  // namespace v2vouch
