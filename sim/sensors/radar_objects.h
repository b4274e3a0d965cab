// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <v2vouch/radar_scan_t.hpp>

#include "daemon/common/base/random.h"
#include "sim/sensors/radar_view.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// The objects of a radar that tracks by itself: confirmed late, coasted, jumping between parts of
/// the vehicle, renumbered, and false ones. Scans must come in order of time.
class RadarObjects {
 public:
  RadarObjects(const RadarFamilySpec& spec, double noise_scale)
      : spec_(spec), noise_scale_(noise_scale) {}

  /// Appends the objects of a scan. @param is_seen whether an actor (by id) has reflected anything.
  void Report(const Snapshot& snapshot, const RadarView& view,
              const std::function<bool(std::int64_t)>& is_seen, Random& random, radar_scan_t& scan);

 private:
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

  void ReportObject(const RadarView& view, const TrackedObject& object, Random& random,
                    radar_scan_t& scan) const;
  void Renew(double time_s, Random& random, TrackedObject& object);

  RadarFamilySpec spec_;
  double noise_scale_;
  std::map<std::int64_t, TrackedObject> objects_;  ///< False ones have negative keys.
  std::int32_t next_track_id_ = 1;
  std::int64_t next_false_ = -2;
  double last_time_s_ = 0.0;
};

}  // namespace v2vouch::sim
