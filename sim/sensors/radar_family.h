// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <v2vouch/radar_scan_t.hpp>
#include <vector>

#include "daemon/common/base/random.h"
#include "sim/sensors/radar_objects.h"
#include "sim/sensors/radar_view.h"
#include "sim/sensors/reflection_points.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// One radar of a sensor family (RadarFamilySpec). A vehicle is a set of points of its own
/// (ReflectionPoints) and the specular point of each visible face; each point has a strength that
/// falls with range^4, fades slowly and fluctuates from scan to scan. Points, scenery, images and
/// clutter of one resolution cell merge, weighted by power, whichever vehicle they belong to; noise
/// is added to what is left, more at low SNR.
///
/// Scans must come in order of time: fading and objects go on from scan to scan.
class RadarFamily {
 public:
  RadarFamily(const RadarFamilySpec& spec, double noise_scale, std::uint64_t index,
              std::uint64_t seed);

  /// Appends the detections of scan number `seq`.
  void Scan(const Snapshot& snapshot, std::int64_t seq, const RadarView& view, radar_scan_t& scan);

 private:
  /// One echo before the resolution cells.
  struct Echo {
    double range_m;
    double azimuth_rad;
    double rate_mps;
    double snr_db;
    std::int64_t vehicle;  ///< Actor's id, or kNobody.
  };
  static constexpr std::int64_t kNobody = -1;

  struct Fading {
    double time_s = 0.0;
    std::vector<double> db;
  };
  void AddEcho(const RadarView& view, const Vec2& place, const Vec2& velocity, double snr_at_20m_db,
               std::int64_t vehicle);
  void AddVehicle(const Snapshot& snapshot, const ActorState& actor, std::size_t index,
                  const RadarView& view, Random& random);
  void AddImages(const Snapshot& snapshot, const ActorState& actor, const RadarView& view,
                 Random& random);
  void AddScenery(const RadarView& view, Random& random);
  void AddClutter(const RadarView& view, Random& random);
  void MergeCells();
  void Report(const RadarView& view, Random& random, radar_scan_t& scan);

  RadarFamilySpec spec_;
  double noise_scale_;
  std::uint64_t index_;
  std::uint64_t seed_;
  std::map<std::int64_t, std::vector<ReflectionPoint>> points_;  ///< Per actor.
  std::map<std::int64_t, Fading> fading_;
  RadarObjects objects_;  ///< Of a radar that tracks by itself.
  std::vector<Echo> echoes_;
};

}  // namespace v2vouch::sim
