// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "calibration/extrinsics/drive_log.h"
#include "calibration/extrinsics/ego_track.h"
#include "calibration/extrinsics/mounting_parameters.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// One return of something that stands, as one radar measured it.
struct StaticReturn {
  int radar = 0;
  std::size_t epoch = 0;  ///< Index of the odometry sample next to it ...
  double dt_s = 0.0;      ///< ... and how much later the scan was.
  double azimuth_rad = 0.0;
  double range_rate_mps = 0.0;
};

/// Doppler of the standing world as an errors-in-variables residual: azimuth is measured, too, and
/// plain least squares would answer its noise with a bias (notes of a 45 degree corner radar: 0.02
/// degrees at 1 degree of azimuth noise). With the velocity of the antenna
///
///     (v_x, v_y) = (v - omega y, -k v^2 omega + omega x),   e(t) = d + v_x cos t + v_y sin t,
///
/// bearing t = yaw + azimuth and range rate d, the azimuth correction c that minimises
/// e(t + c)^2 / sigma_d^2 + c^2 / sigma_a^2 is found first; the residual is
///
///     r = (e(t + c) - e' c) / sqrt(sigma_d^2 + e'^2 sigma_a^2)
///
/// with slope e' held. Its derivatives hold c and e', too.
struct DopplerResidual {
  double azimuth_rad;
  double range_rate_mps;
  double dt_s;
  double accel_mps2;  ///< Of the ego around the scan, as the next.
  double yaw_accel_radps2;
  double range_rate_sigma_mps;
  double azimuth_sigma_rad;

  /// @param radar x, y, yaw.  @param motion v, omega at the odometry sample.  @param slip k.
  /// @param d_radar, d_motion, d_slip derivatives, or null.
  double operator()(const double* radar, const double* motion, double slip, double* d_radar,
                    double* d_motion, double* d_slip) const;
};

/// The ego's speed v and yaw rate omega at an odometry sample: scale and bias taken off.
/// @param ego MountingParameters::Ego().
std::array<double, 2> MotionAt(const EgoTrack::Sample& sample, const double* ego);

struct DopplerSelection {
  double min_speed_mps = 3.0;
  int max_per_radar = 60'000;  ///< Scans are thinned evenly down to so many returns.
  double gate_sigmas = 3.5;
  double slack_rad = 0.0;    ///< What the yaw may still be off by: widens the gate.
  double slack_speed = 0.0;  ///< Share by which the ego's speed may be off: the same.
};

/// The returns that fit a standing world as seen by a car that moves as its odometry says and whose
/// mounting is `parameters`. Objects of a radar that tracks by itself count like reflections; that
/// their noise has been smoothed shows in the blocks (MountingInformation::inflation).
std::vector<StaticReturn> SelectStaticReturns(const DriveLog& log, const EgoTrack& ego,
                                              const VehicleConfig& vehicle,
                                              const MountingParameters& parameters,
                                              const DopplerSelection& selection);

/// The residual of one return.
DopplerResidual ResidualOf(const StaticReturn& one, const EgoTrack& ego, const RadarConfig& radar);

}  // namespace v2vouch
