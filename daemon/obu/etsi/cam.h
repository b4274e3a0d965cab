// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {

/// Cooperative Awareness Message of ETSI EN 302 637-2 (1.3.2 to 1.4.1) and TS 103 900 as raw
/// integers, up to the optional figures of the vehicle's high frequency container. Their codes for
/// "unavailable" are the defaults.
struct Cam {
  int protocol_version = 0;
  std::uint32_t station_id = 0;
  int generation_delta_time = 0;        ///< ms since 2004 (TAI) modulo 65536, of the position.
  int station_type = 0;                 ///< 5 car, 6 bus, 7 and 8 trucks, 15 road side unit.
  std::int32_t latitude = 900000001;    ///< 1e-7 degree.
  std::int32_t longitude = 1800000001;  ///< 1e-7 degree.
  int semi_major = 4095;                ///< cm at 95 %.
  int semi_minor = 4095;
  int orientation = 3601;  ///< 0.1 degree.
  int altitude = 800001;   ///< cm over the ellipsoid.
  int heading = 3601;      ///< 0.1 degree.
  int speed = 16383;       ///< cm/s.
  int direction = 2;       ///< 0 forward, 1 backward.
  int length = 1023;       ///< 0.1 m.
  int width = 62;          ///< 0.1 m.
  int accel_long = 161;    ///< 0.1 m/s^2.
  int curvature = 1023;
  int yaw_rate = 32767;      ///< 0.01 degree/s, left positive.
  int steering_angle = 512;  ///< 1.5 degree, left positive.
  int accel_lateral = 161;   ///< 0.1 m/s^2, left positive.
  int accel_vertical = 161;  ///< 0.1 m/s^2, up positive.

  friend bool operator==(const Cam&, const Cam&) = default;
};

inline constexpr int kStationPedestrian = 1;
inline constexpr int kStationCyclist = 2;
inline constexpr int kStationRoadSide = 15;

/// Whether `bytes` can begin a CAM: version 1 or 2, message id 2.
bool LooksLikeCam(Bytes bytes);

/// @return kNotCam for other messages, kNotVehicle for road side units and people on foot or
///         bicycle, kOutOfRange for a value that the standard does not define.
Fault ReadCam(Bytes bytes, Cam& cam);

}  // namespace v2vouch::obu
