// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <v2vouch/object_list_t.hpp>
#include <vector>

#include "daemon/common/base/random.h"
#include "sim/sensors/radar.h"
#include "sim/sensors/skyline.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// One source of boxes: a lidar with its detector, at roof height but blind over what stands
/// nearer. Realistic mode: position, size and axis with white noise of the configured sigmas; the
/// centre of a partly covered vehicle drawn towards the part that shows, by up to kPartShare of its
/// length; the axis turned by half in one of ten boxes (front and rear), by a quarter in one of
/// fifty; classes confused now and then; false boxes. Velocity (over ground or relative, as
/// configured), ids and covariances as the scenario's `sensors` section says.
///
/// Detection of a vehicle, once per frame:
///     P = detection_probability * R(range) * clamp((visible - 0.1) / 0.4)
/// with R = 1 up to 60 % of the largest range, then falling to 0.5 at its end. Ideal points: as
/// for ideal radar points, position noise alone.
class ObjectSimulator {
 public:
  ObjectSimulator(const World& world, int index, std::uint64_t seed);

  /// Frame number `seq`, measured at the snapshot's time.
  void Detect(const Snapshot& snapshot, std::int64_t seq, object_list_t& list);

  /// How this source sees every actor of the snapshot.
  void Look(const Snapshot& snapshot, std::vector<Sight>& sights);

  static constexpr double kPartShare = 0.25;

 private:
  struct Frame {  // The sensor's own, in the world.
    Vec2 place;
    Vec2 velocity;
    double yaw_rad;
    double yaw_rate_radps;
    [[nodiscard]] Vec2 Turned(const Vec2& in_world) const;
  };
  [[nodiscard]] Frame FrameAt(const EgoTruth& ego) const;
  [[nodiscard]] bool Covers(const Vec2& p_S) const;
  [[nodiscard]] object_t BoxOf(const ActorState& actor, const Sight& sight, const Frame& frame,
                               Random& random) const;
  void PutVelocity(const ActorState& actor, const Vec2& p_S, const Frame& frame, Random& random,
                   object_t& box) const;
  [[nodiscard]] object_t FalseBox(Random& random) const;

  const World& world_;
  ObjectSensorConfig sensor_;
  std::uint64_t index_;
  std::uint64_t seed_;
  Skyline skyline_;
  std::vector<Sight> sights_;
};

}  // namespace v2vouch::sim
