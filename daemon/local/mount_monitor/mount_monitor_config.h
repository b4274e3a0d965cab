// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"

namespace v2vouch {

/// Watches whether a radar still points where the configuration says.
struct MountMonitorConfig {
  bool enabled = true;
  double min_speed_mps = 5.0;           ///< Slower, Doppler says too little of direction.
  double window_s = 60.0;               ///< Of driving at that speed; one verdict each.
  double alarm_rad = FromDegrees(0.2);  ///< A mount that moved less is left alone.
  double alarm_sigmas = 4.0;            ///< And it must be so certain ...
  int alarm_windows = 3;                ///< ... in so many windows running, to the same side.
  /// What no amount of returns averages away: rear-axle slip, crosswind, time stamps.
  double floor_rad = FromDegrees(0.03);
  double speed_scale_sigma = 0.02;  ///< Prior of the odometer's scale, estimated beside.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("enabled", enabled);
    a.Field("min_speed_mps", min_speed_mps, {.at_least = 1.0, .at_most = 50.0});
    a.Field("window_s", window_s, {.at_least = 10.0, .at_most = 3600.0});
    a.Degrees("alarm_deg", alarm_rad, {.above = 0.0, .at_most = 10.0});
    a.Field("alarm_sigmas", alarm_sigmas, {.at_least = 1.0, .at_most = 100.0});
    a.Field("alarm_windows", alarm_windows, {.at_least = 1, .at_most = 100});
    a.Degrees("floor_deg", floor_rad, {.at_least = 0.0, .at_most = 2.0});
    a.Field("speed_scale_sigma", speed_scale_sigma, {.above = 0.0, .at_most = 0.2});
  }
};

}  // namespace v2vouch
