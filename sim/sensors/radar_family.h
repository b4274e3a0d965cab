// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <v2vouch/radar_scan_t.hpp>
#include <vector>

#include "daemon/common/base/random.h"
#include "sim/sensors/reflection_points.h"
#include "sim/sensors/skyline.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// A fixed strong point of the scenery.
struct Scatterer {
  Vec2 place;
  Vec2 normal;  ///< Zero: seen from everywhere.
  double rcs_dbsm;
  double probability;
};

/// What a radar has before it at the time of a scan.
struct RadarView {
  const RadarConfig& radar;
  Vec2 place;  ///< Of the antenna.
  Vec2 velocity;
  double yaw_rad;
  const Skyline& skyline;
  const std::vector<std::vector<int>>& open_rays;  ///< Per actor: rays that meet it first.
  const std::vector<Scatterer>& scatterers;
  const std::vector<std::pair<Vec2, Vec2>>& mirrors;

  [[nodiscard]] double AzimuthTo(const Vec2& point) const;
  /// Whether the point is within field of view and range.
  [[nodiscard]] bool Covers(const Vec2& point) const;
};

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
    Vec2 place;
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
  /// A vehicle, or nothing real, as an object of a radar that tracks by itself.
  struct TrackedObject {
    double seen_since_s = 0.0;
    double last_seen_s = 0.0;
    double jump_s = 0.0;    ///< Next change of the reference point.
    double new_id_s = 0.0;  ///< Next change of identity.
    double x_share = 0.0;   ///< Reference point along the vehicle's axes, +-1 = its ends.
    double y_share = 0.0;
    std::int32_t track_id = 0;
    Vec2 place;  ///< Last reported; coasts with `velocity`.
    Vec2 velocity;
    double ends_s = 0.0;  ///< Of false objects.
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
  void ReportObjects(const Snapshot& snapshot, const RadarView& view, Random& random,
                     radar_scan_t& scan);
  void ReportObject(const RadarView& view, const TrackedObject& object, Random& random,
                    radar_scan_t& scan) const;
  void Renew(double time_s, Random& random, TrackedObject& object);

  RadarFamilySpec spec_;
  double noise_scale_;
  std::uint64_t index_;
  std::uint64_t seed_;
  std::map<std::int64_t, std::vector<ReflectionPoint>> points_;  ///< Per actor.
  std::map<std::int64_t, Fading> fading_;
  std::map<std::int64_t, TrackedObject> objects_;  ///< False ones have negative keys.
  std::int32_t next_track_id_ = 1;
  std::int64_t next_false_ = -2;
  double last_time_s_ = 0.0;
  std::vector<Echo> echoes_;
};

}  // namespace v2vouch::sim
