// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "calibration/extrinsics/drive_log.h"
#include "calibration/extrinsics/drive_problem.h"
#include "calibration/extrinsics/mounting_parameters.h"
#include "calibration/extrinsics/residual_pictures.h"
#include "daemon/common/data/calibration.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

struct ExtrinsicsOptions {
  MountingPriors priors;
  /// Vehicles are points (`tracking.point_targets`): every reflection and every foot is the centre.
  bool point_targets = false;
};

/// How the car was driven: what decides what can be known.
struct Excitation {
  double duration_s = 0.0;
  double moving_s = 0.0;            ///< Above 3 m/s.
  double speed_rms_mps = 0.0;       ///< Of its variation while moving.
  double yaw_rate_rms_radps = 0.0;  ///< While moving.
  double heading_resultant = 1.0;   ///< |mean e^(i yaw)| while moving: 1 = one direction only.
  int static_returns = 0;
  int target_windows = 0;           ///< With radar and camera.
  double bearing_spread_rad = 0.0;  ///< Standard deviation over target windows.
  double inverse_range_spread_pm = 0.0;
  /// Messages used, by sensor: "radar_front", "camera_front", "gnss", "gnss_heading" (fixes with
  /// one). All sensors of the vehicle are there.
  std::map<std::string, int> messages{};
};

/// One group of measurements: how many equations, how well they fit, how correlated their noise is.
struct GroupFit {
  std::string name;
  int equations = 0;
  double chi_square_per_equation = 0.0;
  double robust_chi_square = 0.0;  ///< Outliers left out of account; 1 = as stated.
  double inflation = 1.0;
};

/// One quantity, with what the file does not hold.
struct MountingEstimate : CalibratedParameter {
  double crlb = 0.0;  ///< Cramer-Rao bound of the standard deviation, priors included, white noise.
  double data_std = 0.0;   ///< What the data alone would give; infinite where they say nothing.
  double block_std = 0.0;  ///< As twentieths of the drive scatter.
  /// Whose noise its variance is made of: group's name, share; largest first, 1 % and more.
  std::vector<std::pair<std::string, double>> shares;
  std::string hint;  ///< What driving would help; empty where nothing is lacking.
};

/// A direction in which the data know less than the prior, in words.
struct WeakDirection {
  double information = 0.0;  ///< In units of the prior's.
  std::string description;   ///< E.g. "radar_front.y_m + ego.antenna_y_m".
};

struct ExtrinsicsResult {
  explicit ExtrinsicsResult(const MountingParameters& start) : mounting(start) {}

  bool accepted = false;
  std::vector<std::string> problems;  ///< Why not.
  std::vector<MountingEstimate> parameters;
  Eigen::MatrixXd covariance;  ///< Of all parameters, SI and radians, inflated.
  std::vector<WeakDirection> weak;
  std::vector<GroupFit> groups;
  Excitation excitation;
  MountingParameters mounting;  ///< The values as they stand, SI and radians.
  ResidualPictures pictures;    ///< For the report.
};

/// Stage A: mounting of radars and cameras, antenna, heading bias, speed scale, from the car's own
/// sensors. Three passes: everything robust behind wide gates; then gates and pairs made again with
/// what was learnt, Doppler hard-gated and Gaussian, the rest robust; then once more with all data,
/// and again where some of it turned out to be correlated.
/// @param progress share of the work done, and what is being done.
ExtrinsicsResult CalibrateExtrinsics(const DriveLog& log, const VehicleConfig& vehicle,
                                     const ExtrinsicsOptions& options,
                                     const std::function<void(double, const char*)>& progress);

}  // namespace v2vouch
