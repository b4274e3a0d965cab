// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "daemon/common/base/visit.h"
#include "daemon/common/data/ego.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/measurement.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/local/radar/dbscan.h"
#include "daemon/local/radar/vehicle_merge.h"

namespace v2vouch {

/// Settings of the radar stage: from reflections to clusters with Doppler and extent.
struct RadarPreprocessingConfig {
  double min_snr_db = 6.0;      ///< Weaker reflections are dropped, where the sensor gives SNR.
  double min_rcs_dbsm = -15.0;  ///< Smaller ones too, where it gives RCS: up to 10 m ...
  double rcs_slope_db = 0.0;    ///< ... and this much more per doubling of range beyond.
  double eps_m = 1.2;           ///< DBSCAN radius of moving reflections at the antenna ...
  double eps_per_m = 0.005;     ///< ... and its growth with range, as lateral noise grows.
  double static_eps_m = 0.8;    ///< The same two of standing ones, whose clusters never join.
  double static_eps_per_m = 0.008;
  double eps_speed_mps = 1.5;        ///< Compensated Doppler that counts as one radius.
  int min_points = 1;                ///< Returns of a core point, itself included.
  double vehicle_gap_m = 4.0;        ///< Moving clusters this close may join; 0: they never do ...
  double vehicle_length_m = 13.0;    ///< ... if they fit a box this long along their motion ...
  double vehicle_width_m = 2.2;      ///< ... and this wide across it.
  double static_speed_mps = 0.6;     ///< |ground range rate| below this may be standing.
  double max_length_m = 20.0;        ///< Longer moving clusters are taken apart.
  double max_static_length_m = 8.0;  ///< Longer standing ones too: a car must not drown in a wall.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("min_snr_db", min_snr_db, {.at_least = -20.0, .at_most = 40.0});
    a.Field("min_rcs_dbsm", min_rcs_dbsm, {.at_least = -60.0, .at_most = 40.0});
    a.Field("rcs_slope_db", rcs_slope_db, {.at_least = 0.0, .at_most = 12.0});
    a.Field("eps_m", eps_m, {.above = 0.0, .at_most = 10.0});
    a.Field("eps_per_m", eps_per_m, {.at_least = 0.0, .at_most = 0.2});
    a.Field("static_eps_m", static_eps_m, {.above = 0.0, .at_most = 10.0});
    a.Field("static_eps_per_m", static_eps_per_m, {.at_least = 0.0, .at_most = 0.2});
    a.Field("eps_speed_mps", eps_speed_mps, {.above = 0.0, .at_most = 20.0});
    a.Field("min_points", min_points, {.at_least = 1, .at_most = 20});
    a.Field("vehicle_gap_m", vehicle_gap_m, {.at_least = 0.0, .at_most = 10.0});
    a.Field("vehicle_length_m", vehicle_length_m, {.above = 1.0, .at_most = 30.0});
    a.Field("vehicle_width_m", vehicle_width_m, {.above = 0.5, .at_most = 5.0});
    a.Field("static_speed_mps", static_speed_mps, {.above = 0.0, .at_most = 5.0});
    a.Field("max_length_m", max_length_m, {.above = 1.0, .at_most = 100.0});
    a.Field("max_static_length_m", max_static_length_m, {.above = 1.0, .at_most = 100.0});
  }
};

/// Apparent Doppler of a stationary object at azimuth `a` due to the antenna's motion, and reverse:
///
///     ground range rate = range rate + v_R . [cos a, sin a],   v_R = R_RB [v - w y, w x]
///
/// with the ego's speed v and yaw rate w, and the antenna at (x, y) in B.
struct AntennaMotion {
  Eigen::Vector2d velocity_R = Eigen::Vector2d::Zero();  ///< Over ground [m/s].
  double lever_arm_m = 0.0;  ///< From the rear axle: turns yaw rate error into speed error.
};
AntennaMotion MotionOfAntenna(const RadarConfig& radar, const EgoState& ego);

/// Threshold of weak returns, ego-motion-compensated Doppler (lever arm x yaw rate included),
/// static/moving split, DBSCAN in (x, y, compensated Doppler), cluster -> measurement.
///
/// *Dropped*: not finite, outside the sensor's range or (by more than 3 sigma) azimuth limits,
/// too weak. NaN in SNR or RCS means the sensor has none and drops nothing.
///
/// *Stationary*: |ground range rate| <= max(static_speed, 3 sigma), where sigma holds Doppler
/// noise, azimuth noise x the antenna's speed across the ray, and the ego's own speed and yaw rate
/// noise. A vehicle crossing the ray shows no Doppler and counts as stationary too: is_static is
/// what one scan alone can say. Stationary and moving reflections never share a cluster, so a close
/// crossing vehicle may come out in two or three clusters.
///
/// *One vehicle in pieces*: moving clusters that can be one vehicle are joined (vehicle_merge.h),
/// so that the radius may stay small enough to keep two cars side by side apart.
///
/// *Too long* clusters (facades, guard rails, queues) are clustered again with 0.6, 0.36, 0.22 of
/// the radius, and cut in halves where even that leaves one too long.
///
/// *The measurement* of a cluster of n reflections:
/// - Reference point (range_m, azimuth_rad): the mean of the reflections' positions in the plane.
///   For a vehicle that is a point on or near its visible faces, not its centre.
/// - ground_range_rate_mps: mean over the reflections. range_rate_mps: the same, seen from the
///   moving antenna at the reference's azimuth.
/// - covariance: diagonal, of that mean as a sample mean: max(sensor sigma^2, s^2) / n with s^2
///   the variance found in the cluster along the ray, across it (as an angle), and in Doppler.
///   How far the mean is off the model's point is for the model to add.
/// - near_range_m, radial_extent_m, azimuth edges: over the reflections' own ranges and azimuths.
///   The edges are unwrapped about azimuth_rad, so min <= azimuth_rad <= max holds everywhere.
///
/// A sensor that tracks by itself (kObjects) gives one measurement per object, unclustered, with
/// the reference point that the sensor chose. Measurements come out ordered by azimuth, then range,
/// whatever the order of the detections. Buffers are reused.
class RadarPreprocessor {
 public:
  explicit RadarPreprocessor(const RadarPreprocessingConfig& config) : config_(config) {}
  /// A copy takes over the settings only: the buffers say nothing from one scan to the next, and a
  /// checkpoint must stay cheap.
  RadarPreprocessor(const RadarPreprocessor& other) : config_(other.config_) {}
  RadarPreprocessor& operator=(const RadarPreprocessor& other) {
    config_ = other.config_;
    return *this;
  }

  /// Replaces the content of `measurements`.
  void Process(const RadarScan& scan, const RadarConfig& radar, const EgoState& ego,
               std::vector<RadarMeasurement>& measurements);

 private:
  [[nodiscard]] bool IsKept(const RadarDetection& detection, const RadarConfig& radar) const;
  void Emit(std::span<const int> members, const RadarConfig& radar, const AntennaMotion& antenna,
            std::vector<RadarMeasurement>& measurements);
  void Cluster();

  struct Piece {  // order_[begin, end), to be clustered with the radius of that depth.
    std::size_t begin = 0;
    std::size_t end = 0;
    int depth = 0;
  };

  RadarPreprocessingConfig config_;
  Dbscan dbscan_;
  VehicleMerge merge_;
  std::vector<Reflection> reflections_;  // Kept ones, ordered by range.
  std::vector<OutlineReturn> outline_;
  std::vector<int> order_;  // Indices into them, cluster by cluster.
  std::size_t moving_ = 0;  // Those before are moving, the rest standing.
  std::vector<Piece> pieces_;
  std::vector<int> clustered_;  // Finished clusters, one after another, each ending at an end.
  std::vector<std::size_t> ends_;
};

}  // namespace v2vouch
