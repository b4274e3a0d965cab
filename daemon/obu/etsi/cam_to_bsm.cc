// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/etsi/cam_to_bsm.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/geodesy/curvature.h"
#include "daemon/obu/ieee1609/dot2_time.h"

namespace v2vouch::obu {
namespace {

constexpr double kSigmasAt95 = 2.4477;  // sqrt(chi-square quantile 0.95, 2 degrees of freedom).

std::int32_t Rounded(double value) { return static_cast<std::int32_t>(std::lround(value)); }

// Typical lengths by station type [m], where a CAM gives none.
double TypicalLength(int station_type) {
  switch (station_type) {
    case 3:
    case 4:
      return 2.2;  // Moped, motorcycle.
    case 6:
    case 8:
      return 12.0;  // Bus, heavy lorry.
    case 7:
      return 7.0;
    case 11:
      return 30.0;  // Tram.
    default:
      return 4.6;
  }
}

// Raw 0.05 m at one sigma of cm at 95 %; `extra_m` is what else is not known.
std::int32_t Accuracy(int cm, double extra_m) {
  if (cm >= 4094) return 255;  // 4095 unavailable; 4094 beyond 40.93 m: nothing to rely on.
  return std::clamp(Rounded((cm / 100.0 / kSigmasAt95 + extra_m) / 0.05), 0, 254);
}

void Move(BsmCore& core, double forward_m, double heading_rad) {
  const CurvatureRadii radii = RadiiAt(FromDegrees(core.lat * 1e-7));
  const double north_m = forward_m * std::cos(heading_rad);
  const double east_m = forward_m * std::sin(heading_rad);
  const double lat = core.lat + ToDegrees(north_m / radii.meridian_m) * 1e7;
  double lon = core.lon + ToDegrees(east_m / radii.parallel_m) * 1e7;
  if (lon > 1.8e9) lon -= 3.6e9;
  if (lon <= -1.8e9) lon += 3.6e9;
  core.lat = Rounded(std::clamp(lat, -9e8, 9e8));
  core.lon = static_cast<std::int32_t>(std::clamp(std::llround(lon), -1799999999LL, 1800000000LL));
}

}  // namespace

std::int64_t PositionTime(const Cam& cam, std::int64_t near_utime) {
  const auto near_ms = static_cast<std::int64_t>(Dot2MicrosOfUtc(near_utime) / 1000);
  // The nearest time with these low 16 bits: half a minute to either side.
  const auto offset_ms = static_cast<std::int16_t>(
      static_cast<std::uint16_t>(cam.generation_delta_time - (near_ms & 0xFFFF)));
  const std::int64_t position_ms = std::max<std::int64_t>(near_ms + offset_ms, 0);
  return UtcOfDot2Micros(static_cast<std::uint64_t>(position_ms) * 1000);
}

BsmCore CoreOfCam(const Cam& cam, std::optional<std::int64_t> near_utime) {
  BsmCore core;
  core.id = cam.station_id;
  if (near_utime) {
    core.sec_mark = static_cast<std::int32_t>(PositionTime(cam, *near_utime) / 1000 % 60000);
  }
  core.lat = cam.latitude;
  // -180 degrees is the same meridian as +180, the only name J2735 has for it.
  core.lon = cam.longitude == -1800000000 ? 1800000000 : cam.longitude;
  if (cam.altitude != 800001) {
    core.elev = std::clamp(Rounded(cam.altitude / 10.0), -4095, 61439);
  }
  if (cam.speed != 16383) core.speed = std::min(cam.speed / 2, 8190);
  if (cam.heading != 3601) core.heading = cam.heading % 3600 * 8;
  core.transmission = cam.direction == 0 ? 2 : cam.direction == 1 ? 3 : 7;
  if (cam.accel_long != 161) core.accel_long = cam.accel_long * 10;
  if (cam.accel_lateral != 161) core.accel_lat = -cam.accel_lateral * 10;
  if (cam.accel_vertical != 161) {
    core.accel_vert = std::clamp(Rounded(cam.accel_vertical * 0.1 / (0.02 * 9.80665)), -126, 127);
  }
  if (cam.yaw_rate != 32767) core.accel_yaw = -cam.yaw_rate;
  if (cam.steering_angle != 512) core.angle = std::clamp(-cam.steering_angle, -126, 126);
  if (cam.width != 62) core.width = cam.width * 10;
  if (cam.length != 1023) core.length = std::min(cam.length * 10, 4095);

  const bool has_place = cam.latitude != 900000001 && cam.longitude != 1800000001;
  const bool has_axis = cam.heading != 3601;
  const double half_m =
      0.5 * (cam.length != 1023 ? cam.length * 0.1 : TypicalLength(cam.station_type));
  double extra_m = cam.length == 1023 ? half_m : 0.0;
  if (has_place && has_axis) {
    const double motion_rad = FromDegrees(cam.heading * 0.1);
    Move(core, -half_m, cam.direction == 1 ? motion_rad + kPi : motion_rad);
  } else {
    extra_m = half_m;
  }
  core.semi_major = Accuracy(cam.semi_major, extra_m);
  core.semi_minor = Accuracy(cam.semi_minor, has_axis ? 0.0 : extra_m);
  if (cam.orientation != 3601)
    core.orientation = Rounded(cam.orientation % 3600 * 65535.0 / 3600.0);
  return core;
}

}  // namespace v2vouch::obu
