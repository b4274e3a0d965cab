// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <GeographicLib/LocalCartesian.hpp>
#include <cstdint>
#include <v2vouch/ego_motion_t.hpp>
#include <v2vouch/gnss_fix_t.hpp>

#include "sim/sensors/gnss_error.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// The plane of the world frame W on the ellipsoid (GeographicLib).
GeographicLib::LocalCartesian PlaneOf(const OriginSpec& origin);

/// Geodetic place of a point of W at road height, and how far W's axes are turned against east and
/// north there: a direction of yaw `a` in W is `a + turn_rad` from true east.
struct GeodeticPlace {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;
  double turn_rad = 0.0;
};
GeodeticPlace GeodeticOf(const GeographicLib::LocalCartesian& plane, const Vec2& point,
                         double height_m = 0.0);

/// Clockwise from north, 0..2 pi, of a direction counter-clockwise from east.
double HeadingOf(double yaw_rad);

/// Wheel speed, gyro and accelerometer. A wheel that turns slower than 0.1 m/s reads as standing.
class OdometrySimulator {
 public:
  OdometrySimulator(const World& world, std::uint64_t seed) : world_(world), seed_(seed) {}
  void Measure(const Snapshot& snapshot, std::int64_t seq, ego_motion_t& motion) const;

 private:
  const World& world_;
  std::uint64_t seed_;
};

/// The ego's GNSS receiver at its antenna. The snapshot given is that of the time the fix belongs
/// to (stamp minus VehicleConfig::gnss_latency_s); calls must come in order of time, `dt_s` apart.
class EgoGnssSimulator {
 public:
  EgoGnssSimulator(const World& world, std::uint64_t seed);
  void Measure(const Snapshot& snapshot, std::int64_t seq, double dt_s, gnss_fix_t& fix);

 private:
  const World& world_;
  std::uint64_t seed_;
  GeographicLib::LocalCartesian plane_;
  GnssError error_;
};

}  // namespace v2vouch::sim
