// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/extrinsics/drive_log.h"
#include "calibration/extrinsics/ego_track.h"
#include "calibration/extrinsics/mounting_parameters.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// One moving object in one scan: the mean of the reflections that belong together.
struct ChainHit {
  Timestamp stamp{};
  double range_m = 0.0;
  double azimuth_rad = 0.0;
  double x_O = 0.0;  ///< In the dead-reckoned frame of EgoTrack, with the mounting given.
  double y_O = 0.0;
};

/// What one radar saw of one moving object, scan after scan.
struct RadarChain {
  int radar = 0;
  std::vector<ChainHit> hits;
};

/// Moving reflections of each radar, joined within a scan where they lie close together, then from
/// scan to scan by the nearest prediction. For pairing with pictures only: a chain that goes over
/// from one vehicle to another is two half-good chains, not an error that lasts.
std::vector<RadarChain> ChainMovingReturns(const DriveLog& log, const EgoTrack& ego,
                                           const VehicleConfig& vehicle,
                                           const MountingParameters& parameters);

}  // namespace v2vouch
