// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/base/reason.h"
#include "daemon/common/base/visit.h"
#include "daemon/common/data/claim.h"
#include "daemon/common/data/ego.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/common/geodesy/ecef.h"
#include "daemon/v2v/alignment/alignment_filter.h"
#include "daemon/v2v/alignment/alignment_start.h"

namespace v2vouch {

struct AlignmentConfig {
  double min_course_speed_mps = 3.0;  ///< Course over ground is used above this only.
  double jump_m = 4.0;  ///< A fix farther than this (plus 4 sigma) from the prediction is a jump.
  double reanchor_m = 5000.0;     ///< L gets a new origin beyond this distance.
  double drift_per_m = 0.01;      ///< Random drift of O: sigma = this * sqrt(10 m * distance).
  double yaw_drift_per_s = 3e-4;  ///< Random walk of the yaw offset [rad/sqrt(s)].
  double position_floor_m = 0.3;  ///< A fix is never believed better than this.
  double slow_error_m = 0.8;     ///< Slow (unfilterable) part of a fix' error, never averaged away.
  double yaw_floor_rad = 0.003;  ///< The yaw offset is never believed better than this.

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

/// Where O lies in the local east-north-up plane L. Copyable.
///
///     p_L = X_LO * p_O,  X_LO estimated by an EKF over GNSS positions, courses and headings
///
/// Lever arm and latency of the antenna are applied. Everything is projected along its own vertical
/// (heights are taken out first), so an unknown height moves nothing sideways. L's origin lies on a
/// lattice of 0.01 degrees, so it does not depend on which fix came first; a new origin leaves
/// every point in O where it was (below 1 mm).
///
/// Starts with a position and a yaw source (see AlignmentStart): any receiver will do, in traffic
/// too. At standstill the car's pose in L is held in direction, and its position is only averaged.
///
/// A jump freezes the estimate (dead reckoning carries it) and raises `is_suspect`. It thaws when
/// fixes agree with the dead-reckoned prediction for 1 s, or, when the new place has been the
/// consistent one over 10 s of driving, by moving there, with the flag kept for 10 s more. A car
/// that stands cannot tell the places apart and never moves; nor does one whose present alignment
/// was vouched for in the last 5 s.
///
/// The first fixes are believed no more than those that follow: until 10 s of fixes have agreed
/// with the estimate it is overruled, at once and without a flag kept, by another place that more
/// (by duration, at least 1 s and 3 fixes) agree with, and with odometry. Its direction, if it was
/// never confirmed by 20 m of way, is overruled by 20 m of way.
class Alignment {
 public:
  Alignment(const AlignmentConfig& config, const VehicleConfig& vehicle);

  /// @param ego the ego in O at the fix' time (latency applied by the caller through FixTime).
  /// @return why the fix was not used, or nullopt.
  std::optional<Refusal> OnFix(const GnssFix& fix, const EgoState& ego);
  /// When the fix was true: its stamp less the receiver's latency.
  [[nodiscard]] Timestamp FixTime(const GnssFix& fix) const;
  /// A claim brought over by this alignment agreed with the own sensors at `at`.
  void Vouch(Timestamp at);

  [[nodiscard]] bool is_ready() const { return is_ready_; }
  [[nodiscard]] bool is_suspect() const { return is_suspect_; }
  [[nodiscard]] const LocalPlane& plane() const { return plane_; }
  [[nodiscard]] Pose<LocalEnu, Odometry> X_LO() const;
  /// Of [x, y, yaw] of X_LO, consider terms included. Far from O's origin x and y hang on yaw;
  /// CovarianceAt is the uncertainty of a position.
  [[nodiscard]] const Eigen::Matrix3d& covariance() const { return covariance_; }
  /// Of the place in L of a point fixed in O [m^2], consider terms included.
  [[nodiscard]] Eigen::Matrix2d CovarianceAt(const Eigen::Vector2d& p_O) const;

  /// A claim brought into O and carried to `at`, aged by its own speed, course, acceleration and
  /// yaw rate (constant turn rate and acceleration) over age_s + (at - received), at most 3 s. Its
  /// noise grows with that time. Requires is_ready().
  [[nodiscard]] ClaimInOdometry ToOdometry(const Claim& claim, Timestamp at) const;
  /// The geodetic position of a point in O. Requires is_ready().
  [[nodiscard]] Wgs84 ToGeodetic(const Eigen::Vector2d& p_O, double height_m) const;
  /// The ego's footprint centre, height as of the last fix used that had one,
  /// else 0. Requires is_ready().
  [[nodiscard]] Wgs84 EgoGeodetic(const EgoState& ego) const;

 private:
  // A second opinion on where the car is, grown from the fixes that contradict the estimate.
  struct Candidate {
    LocalPlane plane;
    AlignmentFilter filter;
    Timestamp last{};        // Fix that agreed.
    double driven_s = 0.0;   // While fixes agreed.
    double support_s = 0.0;  // Of fixes that agreed, less of those that did not.
    double way_m = 0.0;
    int fixes = 1;
    bool is_guess = false;  // No fix gave its direction.
  };

  [[nodiscard]] bool IsFar(const LocalPlane& plane, const GnssFix& fix) const;
  [[nodiscard]] bool IsEstablished() const;
  [[nodiscard]] bool HasWon(const Candidate& candidate) const;
  [[nodiscard]] std::optional<AlignmentFilter> TryStart(const GnssFix& fix,
                                                        const Eigen::Matrix2d& covariance_en,
                                                        const EgoState& ego);
  void Agree(double dt_s, const EgoState& ego);
  void Challenge(const GnssFix& fix, const Eigen::Matrix2d& covariance_en, double dt_s,
                 const EgoState& ego);
  void FollowCandidate(const GnssFix& fix, const Eigen::Matrix2d& covariance_en, double dt_s,
                       const EgoState& ego);
  void ReanchorIfFar();
  void Publish();

  AlignmentConfig config_;
  VehicleConfig vehicle_;
  Eigen::Vector2d antenna_B_;
  AlignmentNoise noise_;
  bool is_ready_ = false;
  bool is_suspect_ = false;
  LocalPlane plane_{Wgs84{}};
  AlignmentFilter filter_;
  std::optional<LocalPlane> start_plane_;  // In which `start_` works.
  AlignmentStart start_;                   // Of the estimate, then of candidates.
  std::optional<Candidate> candidate_;
  double support_s_ = 0.0;                  // Of fixes that agreed since the start.
  double way_m_ = 0.0;                      // Driven meanwhile.
  std::optional<Timestamp> agrees_since_;   // While suspect: since when fixes agree again.
  std::optional<Timestamp> suspect_until_;  // After a move.
  std::optional<Timestamp> vouched_;
  std::optional<Timestamp> newest_;
  std::optional<double> height_m_;
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Identity();
};

}  // namespace v2vouch
