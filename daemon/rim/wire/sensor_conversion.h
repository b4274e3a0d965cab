// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "daemon/common/base/refusal_tally.h"
#include "daemon/common/base/result.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/vehicle.h"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/object_list_t.hpp"
#include "v2vouch/radar_scan_t.hpp"

namespace v2vouch::wire {

/// Well-formed messages of the own sensors -> data, with the content judged: what a message cannot
/// do without must be finite, in a range that physics allows, and from the sensor whose channel it
/// came on; any other figure that is unknown or cannot be is left unused by itself, with the
/// default that its .lcm file states. The sensor's sign conventions, range offset and clock offset
/// (data/vehicle.h) are applied here and nowhere else; so is what the ego's own instruments are
/// known to be off by.
/// One bad detection or box is left out and counted in `dropped`, as is every figure left unused
/// that is no documented "unavailable" (kFieldUnused); the others stay.
Result<RadarScan> FromWire(const radar_scan_t& message, const RadarConfig& radar, int index,
                           Timestamp received, RefusalTally& dropped);
Result<CameraDetections> FromWire(const camera_detections_t& message, const CameraConfig& camera,
                                  int index, Timestamp received, RefusalTally& dropped);
Result<ObjectList> FromWire(const object_list_t& message, const ObjectSensorConfig& source,
                            int index, Timestamp received, RefusalTally& dropped);
/// speed = measured / speed_scale,  yaw rate = measured - yaw_rate_bias.
Result<EgoMotion> FromWire(const ego_motion_t& message, const VehicleConfig& vehicle,
                           Timestamp received, RefusalTally& unused);

/// Heading (clockwise from north) becomes yaw (counter-clockwise from east), less heading_bias.
Result<GnssFix> FromWire(const gnss_fix_t& message, const VehicleConfig& vehicle,
                         Timestamp received, RefusalTally& unused);

}  // namespace v2vouch::wire
