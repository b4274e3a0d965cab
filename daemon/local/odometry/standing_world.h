// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "daemon/common/data/input.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// How much of what a scan saw agrees with one speed of the ego, in grid cells of 3 m: a wall or
/// ten posts count, a lorry's twenty returns do not.
struct SpeedSupport {
  int cells = 0;
  int left = 0;            ///< Of those, beside the ego's path ...
  int right = 0;           ///< ... on either side (|y| > 1.5 m).
  double speed_mps = 0.0;  ///< Weighted mean of the votes that agree.
  double sigma_mps = 0.0;  ///< Its standard deviation.
};

/// Ego speed from the Doppler of one radar scan. Whatever stands still at body azimuth `a`, seen by
/// an antenna at (x, y) of a car that turns with w, tells the speed
///
///     v = (-range rate - w (x sin a - y cos a)) / cos a
///
/// so each return is a vote, and the speed on which most grid cells agree is that of the standing
/// world - or of many vehicles at one speed, which only SpeedCheck can tell apart. Returns more
/// than 70 degrees off the ego's axis do not vote. The order of detections does not matter. Working
/// memory only: holds no state from scan to scan.
class StandingWorld {
 public:
  struct Vote {
    double speed_mps = 0.0;
    double sigma_mps = 0.0;
    double lever_m = 0.0;  ///< d speed / d yaw rate error = x tan a - y.
    int cell = 0;
    int side = 0;  ///< -1 right, 0 ahead or behind, 1 left.
  };

  void Read(const RadarScan& scan, const RadarConfig& radar, double yaw_rate_radps);

  /// Support for `speed_mps` to within 3 sigma (0.2 m/s at least).
  [[nodiscard]] SpeedSupport Of(double speed_mps) const;
  /// The speed with most support, among those from `low_mps` to `high_mps`.
  [[nodiscard]] SpeedSupport Strongest(double low_mps, double high_mps);
  /// By speed.
  [[nodiscard]] std::span<const Vote> votes() const { return votes_; }

 private:
  std::vector<Vote> votes_;
};

}  // namespace v2vouch
