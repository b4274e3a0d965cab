// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/extrinsics/radar_chains.h"

namespace v2vouch {

/// Turns the camera towards the boxes before anything is paired: the yaw and pitch at which most
/// boxes lie where some chain is predicted, from a histogram of all differences within 5 degrees.
/// Left as it is where no such angle stands out.
void AimCamera(const DriveLog& log, const EgoTrack& ego, const VehicleConfig& vehicle, int camera,
               const std::vector<RadarChain>& chains, MountingParameters& parameters);

}  // namespace v2vouch
