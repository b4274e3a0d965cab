// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// Points with velocities over ground in the body frame, as three radars of a car see them.
struct Reflector {
  double x_m = 0.0;
  double y_m = 0.0;
  double vx_mps = 0.0;  ///< Over ground, along the ego's axis.
};

inline std::vector<Reflector> Posts(double y_m, double every_m = 12.0) {
  std::vector<Reflector> posts;
  for (double x_m = -48.0; x_m <= 72.0; x_m += every_m) posts.push_back({x_m, y_m, 0.0});
  return posts;
}

/// A lane of cars, four returns each.
inline std::vector<Reflector> Lane(double y_m, double vx_mps, double every_m = 9.0) {
  std::vector<Reflector> lane;
  for (double x_m = -30.0; x_m <= 50.0; x_m += every_m) {
    for (const double along_m : {-2.0, -1.0, 1.0, 2.0}) {
      lane.push_back({x_m + along_m, y_m + 0.2 * along_m, vx_mps});
    }
  }
  return lane;
}

inline std::vector<RadarConfig> ThreeRadars() {
  std::vector<RadarConfig> radars(3);
  radars[0].x_m = 3.7;
  radars[1].x_m = 3.4;
  radars[1].y_m = 0.8;
  radars[1].yaw_rad = FromDegrees(50.0);
  radars[2].x_m = 3.4;
  radars[2].y_m = -0.8;
  radars[2].yaw_rad = FromDegrees(-50.0);
  return radars;
}

/// One scan of an ego with this speed and yaw rate. `noise` in [-1, 1] is scaled to 2 sigma.
template <class Noise>
RadarScan Scan(const RadarConfig& radar, const std::vector<Reflector>& scene, double speed_mps,
               double yaw_rate_radps, Noise noise) {
  RadarScan scan;
  for (const Reflector& r : scene) {
    const double dx = r.x_m - radar.x_m;
    const double dy = r.y_m - radar.y_m;
    const double bearing = std::atan2(dy, dx);
    RadarDetection d;
    d.range_m = std::hypot(dx, dy);
    d.azimuth_rad = WrapAngle(bearing - radar.yaw_rad);
    if (std::abs(d.azimuth_rad) > radar.half_fov_rad || d.range_m < 1.0) continue;
    const double vx = r.vx_mps - (speed_mps - yaw_rate_radps * radar.y_m);
    const double vy = -yaw_rate_radps * radar.x_m;
    d.range_rate_mps = vx * std::cos(bearing) + vy * std::sin(bearing) +
                       2.0 * radar.range_rate_sigma_mps * noise();
    d.azimuth_rad += 2.0 * radar.azimuth_sigma_rad * noise();
    scan.detections.push_back(d);
  }
  return scan;
}

}  // namespace v2vouch
