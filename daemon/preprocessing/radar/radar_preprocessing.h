// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/base/visit.h"
#include "daemon/data/ego.h"
#include "daemon/data/input.h"
#include "daemon/data/measurement.h"
#include "daemon/data/vehicle.h"

namespace v2vouch {

/// Settings of the radar stage (DESIGN 5.1).
struct RadarPreprocessingConfig {
  double min_snr_db = 6.0;       ///< Weaker reflections are dropped, where the sensor gives SNR.
  double min_rcs_dbsm = -15.0;   ///< At 10 m; rises by rcs_slope_db per doubling of range.
  double rcs_slope_db = 0.0;
  double eps_m = 1.6;            ///< DBSCAN radius at the antenna.
  double eps_per_m = 0.015;      ///< Growth of the radius with range: lateral noise does the same.
  double eps_speed_mps = 1.5;    ///< Compensated Doppler that counts as one eps.
  int min_points = 1;            ///< Returns of a core point, itself included.
  double static_speed_mps = 0.6; ///< |ground range rate| below this may be standing.
  double max_length_m = 20.0;    ///< Longer clusters are structures, split off as static.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("min_snr_db", min_snr_db, {.at_least = -20.0, .at_most = 40.0});
    a.Field("min_rcs_dbsm", min_rcs_dbsm, {.at_least = -60.0, .at_most = 40.0});
    a.Field("rcs_slope_db", rcs_slope_db, {.at_least = 0.0, .at_most = 12.0});
    a.Field("eps_m", eps_m, {.above = 0.0, .at_most = 10.0});
    a.Field("eps_per_m", eps_per_m, {.at_least = 0.0, .at_most = 0.2});
    a.Field("eps_speed_mps", eps_speed_mps, {.above = 0.0, .at_most = 20.0});
    a.Field("min_points", min_points, {.at_least = 1, .at_most = 20});
    a.Field("static_speed_mps", static_speed_mps, {.above = 0.0, .at_most = 5.0});
    a.Field("max_length_m", max_length_m, {.above = 1.0, .at_most = 100.0});
  }
};

/// Threshold of weak returns, ego-motion-compensated Doppler (lever arm x yaw rate included),
/// static/moving split, DBSCAN in (x, y, compensated Doppler), cluster -> measurement.
/// Clusters come out ordered by azimuth, then range. A sensor that tracks by itself (kObjects)
/// gives one measurement per object, unclustered. Buffers are reused.
class RadarPreprocessor {
 public:
  explicit RadarPreprocessor(const RadarPreprocessingConfig& config) : config_(config) {}

  void Process(const RadarScan& scan, const RadarConfig& radar, const EgoState& ego,
               std::vector<RadarMeasurement>& measurements);

 private:
  RadarPreprocessingConfig config_;
  std::vector<double> x_m_, y_m_, ground_rate_mps_;
  std::vector<int> kept_, label_, queue_, neighbours_;
};

}  // namespace v2vouch
