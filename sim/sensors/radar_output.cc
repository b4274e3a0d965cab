// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/radar_output.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::sim {

bool Covers(const RadarConfig& radar, double range_m, double azimuth_rad) {
  return range_m >= std::max(0.1, radar.min_range_m) && range_m <= radar.max_range_m &&
         std::abs(azimuth_rad) <= radar.half_fov_rad;
}

radar_detection_t Reported(const RadarConfig& radar, double range_m, double azimuth_rad,
                           double range_rate_mps) {
  radar_detection_t detection{};
  detection.range_m = range_m - radar.range_offset_m;
  detection.azimuth_rad = WrapAngle(radar.flip_azimuth ? -azimuth_rad : azimuth_rad);
  detection.range_rate_mps = radar.flip_range_rate ? -range_rate_mps : range_rate_mps;
  detection.track_id = -1;
  return detection;
}

Vec2 Mirrored(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = (b - a).normalized();
  return 2.0 * (a + (p - a).dot(along) * along) - p;
}

}  // namespace v2vouch::sim
