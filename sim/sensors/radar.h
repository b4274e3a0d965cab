// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <v2vouch/radar_scan_t.hpp>
#include <vector>

#include "daemon/common/base/random.h"
#include "sim/sensors/radar_family.h"
#include "sim/sensors/skyline.h"
#include "sim/sensors/usual_reflections.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// What one sensor can know of one vehicle.
struct Sight {
  double visible_fraction = 0.0;       ///< Of its silhouette inside the field of view.
  double detection_probability = 0.0;  ///< In one look.
};

/// One radar. Realistic mode: several reflections per vehicle, at corners, wheel houses and face
/// centres of the sides it sees and anywhere on them, fewer with distance; standing returns of
/// facades, poles, rails and parked cars; mirror images over rails and facades; double bounces;
/// clutter. Noise of every reflection is white with the configured sigmas; Doppler holds the
/// antenna's own velocity (lever arm x yaw rate) and the target's rotation.
///
/// Detection of a vehicle, once per scan:
///     P = detection_probability * R(range) * min(1, visible / 0.2)
/// with R = 1 up to 70 % of the largest range, then falling to 0.6 at its end. Ideal points:
/// P = detection_probability where half the silhouette or more is visible and the centre is within
/// range and field of view, else 0; one detection at the centre. Modes with a family: RadarFamily;
/// P as in realistic mode.
class RadarSimulator {
 public:
  RadarSimulator(const World& world, int index, std::uint64_t seed);

  /// Scan number `seq`, measured at the snapshot's time. Conventions of the sensor (flips, range
  /// and clock offset) are those of its configuration, applied backwards.
  void Scan(const Snapshot& snapshot, std::int64_t seq, radar_scan_t& scan);

  /// How this radar sees every actor of the snapshot.
  void Look(const Snapshot& snapshot, std::vector<Sight>& sights);

 private:
  struct Antenna {
    Vec2 place;
    Vec2 velocity;
    double yaw_rad;
  };

  [[nodiscard]] Antenna AntennaAt(const EgoTruth& ego) const;
  void AddVehicles(const Snapshot& snapshot, std::int64_t seq, const Antenna& antenna,
                   radar_scan_t& scan);
  void AddStatics(std::int64_t seq, const Antenna& antenna, radar_scan_t& scan);
  void AddGhosts(const Snapshot& snapshot, std::int64_t seq, const Antenna& antenna,
                 radar_scan_t& scan);
  void AddClutter(std::int64_t seq, const Antenna& antenna, radar_scan_t& scan);
  /// Appends the reflection of a point if the radar covers it. @return whether it does.
  bool AddPoint(const Antenna& antenna, const Vec2& place, const Vec2& velocity, double rcs_dbsm,
                int track_id, Random& random, radar_scan_t& scan) const;

  void Spoil(std::int64_t seq, radar_scan_t& scan) const;

  const World& world_;
  RadarConfig radar_;
  std::uint64_t index_;
  std::uint64_t seed_;
  Skyline skyline_;
  Scenery scenery_;
  std::vector<Sight> sights_;
  std::vector<std::vector<int>> open_rays_;  ///< Per actor: rays that meet it first, within range.
  std::optional<RadarFamily> family_;        ///< Of modes that have one.
};

}  // namespace v2vouch::sim
