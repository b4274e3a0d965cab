// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/common/data/object_class.h"
#include "sim/world/geometry.h"
#include "sim/world/scenario.h"

namespace v2vouch::sim {

/// One point of a vehicle that answers radars.
struct ReflectionPoint {
  Vec2 local;  ///< Along the vehicle's axes, from the centre [m].
  double db;   ///< SNR at 20 m.
  /// Outward normals of the faces it belongs to (a corner has two), vehicle axes; zero = none. A
  /// point without is inside: seen wherever the vehicle is.
  Vec2 normals[2] = {Vec2::Zero(), Vec2::Zero()};
  bool is_wheel = false;
};

/// The points of one vehicle, the same in every run of the seed and for every radar: corners,
/// wheels, points on its faces and inside. Long vehicles have more of the last two; motorcycles
/// and cyclists have a face and an inside point, pedestrians one.
std::vector<ReflectionPoint> PointsOf(const RadarFamilySpec& spec, ObjectClass object_class,
                                      const Size& size, std::int64_t id, std::uint64_t seed);

/// How much stronger than a car a vehicle of this class answers [dB].
double ClassGain(ObjectClass object_class);

/// The faces of `box` that look towards `from`: outward normal and the point of the face nearest to
/// `from`, vehicle axes, with the angle between the normal and the way from there [rad].
struct FacingSide {
  Vec2 normal;
  Vec2 nearest;
  double off_normal_rad;
};
std::vector<FacingSide> FacingSides(const Box& box, const Vec2& from);

}  // namespace v2vouch::sim
