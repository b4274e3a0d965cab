// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "daemon/obu/etsi/cam.h"
#include "daemon/obu/j2735/bsm.h"

namespace v2vouch::obu {

/// What a CAM says, in the terms of a BSM:
///
/// - The reference point is the centre of the front edge (EN 302 637-2 B.21); BSM's is the centre
/// of
///   the footprint: moved back by half the length along the body axis. Where the length or the axis
///   is unknown, half a typical length goes into the accuracy.
/// - Accuracy ellipses are 95 %: one sigma is a 2.4477th (2 degrees of freedom).
/// - Yaw rate, lateral acceleration and steering angle are positive to the left there, to the right
///   here.
/// - secMark is the time of the position: generationDeltaTime, unwrapped round `near_utime`;
///   unavailable without.
/// - msgCnt, which a CAM has not, is 0 here; CamCounts of obu/message counts.
///
/// @param near_utime reception, or the envelope's time of generation, us UTC.
BsmCore CoreOfCam(const Cam& cam, std::optional<std::int64_t> near_utime);

/// Time of the CAM's position, us UTC.
std::int64_t PositionTime(const Cam& cam, std::int64_t near_utime);

}  // namespace v2vouch::obu
