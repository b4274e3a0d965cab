// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/extrinsics/radar_chains.h"

namespace v2vouch {

/// The ego's pose at one observation, in the body frame at its window's middle.
struct LookPose {
  double dt_s = 0.0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

/// One moving vehicle over a few tenths of a second, as radars and cameras saw it. Its motion is
/// four unknowns, place and velocity in the middle, in body frame B there.
struct TargetWindow {
  struct RadarLook {
    int radar = 0;
    std::size_t chain = 0;
    LookPose pose;
    double range_m = 0.0;
    double azimuth_rad = 0.0;
  };
  struct CameraLook {
    int camera = 0;
    std::size_t picture = 0;  ///< Index into DriveLog::pictures.
    LookPose pose;
    double u_px = 0.0;  ///< Middle of the box's lower edge.
    double v_px = 0.0;
  };
  Timestamp middle{};
  double state[4] = {0.0, 0.0, 0.0, 0.0};  ///< x, y, v_x, v_y.
  std::vector<RadarLook> radar_looks;
  std::vector<CameraLook> camera_looks;
};

/// Pairs of radar chains and boxes. A box belongs to the chain whose prediction, through the camera
/// as it is known so far, is nearest and within `gate_rad`; both must be each other's nearest and
/// the next nearest twice as far off. Boxes cut by the picture's border are left out. Windows that
/// one radar alone saw carry no information and are left out, too.
std::vector<TargetWindow> PairTargets(const DriveLog& log, const EgoTrack& ego,
                                      const VehicleConfig& vehicle,
                                      const MountingParameters& parameters,
                                      const std::vector<RadarChain>& chains, double gate_rad);

}  // namespace v2vouch
