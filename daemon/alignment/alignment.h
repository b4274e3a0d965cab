// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/base/reason.h"
#include "daemon/base/visit.h"
#include "daemon/data/claim.h"
#include "daemon/data/ego.h"
#include "daemon/data/input.h"
#include "daemon/data/vehicle.h"
#include "daemon/geodesy/ecef.h"

namespace v2vouch {

struct AlignmentConfig {
  double min_course_speed_mps = 3.0;  ///< Course over ground is used above this only.
  double jump_m = 4.0;                ///< A fix farther than this (plus 4 sigma) from the prediction is a jump.
  double reanchor_m = 5000.0;         ///< L gets a new origin beyond this distance.
  double drift_per_m = 0.01;          ///< Growth of the offset's sigma with distance driven.
  double yaw_drift_per_s = 3e-4;      ///< Random walk of the yaw offset [rad/sqrt(s)].
  double position_floor_m = 0.3;      ///< A fix is never believed better than this.
  double slow_error_m = 0.8;          ///< Slow (unfilterable) part of a fix' error, never averaged away.
  double yaw_floor_rad = 0.003;       ///< The yaw offset is never believed better than this.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("min_course_speed_mps", min_course_speed_mps, {.at_least = 0.5, .at_most = 20.0});
    a.Field("jump_m", jump_m, {.above = 0.5, .at_most = 100.0});
    a.Field("reanchor_m", reanchor_m, {.at_least = 100.0, .at_most = 50000.0});
    a.Field("drift_per_m", drift_per_m, {.at_least = 0.0, .at_most = 0.2});
    a.Field("yaw_drift_per_s", yaw_drift_per_s, {.at_least = 0.0, .at_most = 0.1});
    a.Field("position_floor_m", position_floor_m, {.above = 0.0, .at_most = 10.0});
    a.Field("slow_error_m", slow_error_m, {.at_least = 0.0, .at_most = 20.0});
    a.Field("yaw_floor_rad", yaw_floor_rad, {.at_least = 0.0, .at_most = 0.2});
  }
};

/// Where O lies in the local east-north-up plane L (DESIGN 5.5). Copyable.
///
///     p_L = X_LO * p_O,  X_LO estimated by an EKF over GNSS positions and courses
///
/// Lever arm and latency of the antenna are applied. A jump freezes the estimate and raises
/// `is_suspect`; it thaws when fixes agree with the dead-reckoned prediction again, or, when the new
/// place is the consistent one for 10 s, by moving there with the flag kept for that time.
class Alignment {
 public:
  Alignment(const AlignmentConfig& config, const VehicleConfig& vehicle);

  /// @param ego the ego in O at the fix' time (latency applied by the caller through FixTime).
  /// @return why the fix was not used, or nullopt.
  std::optional<Reason> OnFix(const GnssFix& fix, const EgoState& ego);
  [[nodiscard]] Timestamp FixTime(const GnssFix& fix) const;

  [[nodiscard]] bool is_ready() const { return is_ready_; }
  [[nodiscard]] bool is_suspect() const { return is_suspect_; }
  [[nodiscard]] const LocalPlane& plane() const { return plane_; }
  [[nodiscard]] Pose<LocalEnu, Odometry> X_LO() const;
  /// Of [x, y, yaw] of X_LO, consider terms included.
  [[nodiscard]] const Eigen::Matrix3d& covariance() const { return covariance_; }

  /// A claim at its reception plus `dt_s`, aged by its own speed, course, acceleration and yaw rate
  /// and brought into O. Requires is_ready().
  [[nodiscard]] ClaimInOdometry ToOdometry(const Claim& claim, Timestamp at) const;
  /// The geodetic position of a point in O. Requires is_ready().
  [[nodiscard]] Wgs84 ToGeodetic(const Eigen::Vector2d& p_O, double height_m) const;

 private:
  AlignmentConfig config_;
  VehicleConfig vehicle_;
  bool is_ready_ = false;
  bool is_suspect_ = false;
  LocalPlane plane_{Wgs84{}};
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Identity();
};

}  // namespace v2vouch
