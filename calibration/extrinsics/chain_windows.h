// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "calibration/extrinsics/ego_track.h"
#include "calibration/extrinsics/target_windows.h"

namespace v2vouch {

/// Length of a window: vehicles keep their velocity over it, and a radar of 10 Hz sees each four
/// times.
inline constexpr std::int64_t kWindow_us = 400'000;

/// Pose of one observation in the body frame at its window's middle.
LookPose PoseOf(const EgoTrack::Place& at, const EgoTrack::Place& middle, double dt_s);

/// All windows of the drive, in order of time, with their radar observations: chains that several
/// radars have of one vehicle share a window.
std::vector<TargetWindow> MakeWindows(const EgoTrack& ego, const std::vector<RadarChain>& chains);

}  // namespace v2vouch
