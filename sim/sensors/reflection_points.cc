// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/reflection_points.h"

#include <algorithm>
#include <cmath>

#include "sim/sensors/subject.h"

namespace v2vouch::sim {
namespace {

bool IsSlim(ObjectClass object_class) {
  return object_class == ObjectClass::kMotorcycle || object_class == ObjectClass::kCyclist ||
         object_class == ObjectClass::kPedestrian;
}

}  // namespace

double ClassGain(ObjectClass object_class) {
  switch (object_class) {
    case ObjectClass::kTruck:
    case ObjectClass::kBus:
      return 7.0;
    case ObjectClass::kVan:
      return 3.0;
    case ObjectClass::kMotorcycle:
      return -6.0;
    case ObjectClass::kCyclist:
    case ObjectClass::kPedestrian:
      return -12.0;
    default:
      return 0.0;
  }
}

std::vector<ReflectionPoint> PointsOf(const RadarFamilySpec& spec, ObjectClass object_class,
                                      const Size& size, std::int64_t id, std::uint64_t seed) {
  Random random = SubjectRandom(seed, "reflection points", {static_cast<std::uint64_t>(id)});
  const double l = 0.5 * size.length_m, w = 0.5 * size.width_m;
  const double gain = ClassGain(object_class);
  const Vec2 ahead(1.0, 0.0), left(0.0, 1.0);
  std::vector<ReflectionPoint> points;
  const auto add = [&](double x, double y, double db, const Vec2& a, const Vec2& b, bool is_wheel) {
    points.push_back(
        {{x, y}, db + gain + random.Normal(0.0, spec.point_spread_db), {a, b}, is_wheel});
  };
  const bool is_slim = IsSlim(object_class);
  const double inset = std::min({0.15, 0.3 * l, 0.3 * w});
  for (const double end : {1.0, -1.0}) {
    for (const double side : {1.0, -1.0}) {
      if (is_slim) break;
      add(end * (l - inset), side * (w - inset), spec.corner_db, end * ahead, side * left, false);
      add(end * 0.3 * size.length_m, side * (w - inset), spec.wheel_db, side * left, Vec2::Zero(),
          true);
    }
    const int on_end = is_slim ? 1 : spec.face_points;
    for (int k = 0; k < on_end; ++k) {
      add(end * (l - random.Uniform(0.0, inset)), random.Uniform(-w, w), spec.face_db, end * ahead,
          Vec2::Zero(), false);
    }
    const double longer = std::max(1.0, size.length_m / 4.5);
    const int on_side = is_slim ? 1 : static_cast<int>(std::lround(spec.face_points * longer));
    for (int k = 0; k < on_side; ++k) {
      add(random.Uniform(-l, l), end * (w - random.Uniform(0.0, inset)), spec.face_db, end * left,
          Vec2::Zero(), false);
    }
  }
  const double longer = std::clamp(size.length_m / 4.5, 0.5, 3.0);
  const int inside = is_slim ? 1 : static_cast<int>(std::lround(spec.inside_points * longer));
  for (int k = 0; k < inside; ++k) {
    add(random.Uniform(-1.0, 1.0) * l * spec.inside_depth, random.Uniform(-0.8, 0.8) * w,
        spec.inside_db, Vec2::Zero(), Vec2::Zero(), false);
  }
  return points;
}

std::vector<FacingSide> FacingSides(const Box& box, const Vec2& from) {
  const Vec2 there = box.Local(from);
  const double l = 0.5 * box.length_m, w = 0.5 * box.width_m;
  std::vector<FacingSide> sides;
  const auto add = [&](const Vec2& normal, const Vec2& nearest) {
    const Vec2 way = there - nearest;
    const double length = way.norm();
    const double cosine = length > 0.0 ? std::clamp(normal.dot(way) / length, -1.0, 1.0) : 1.0;
    sides.push_back({normal, nearest, std::acos(cosine)});
  };
  if (std::abs(there.x()) > l) {
    const double end = there.x() > 0.0 ? 1.0 : -1.0;
    add({end, 0.0}, {end * l, std::clamp(there.y(), -w, w)});
  }
  if (std::abs(there.y()) > w) {
    const double side = there.y() > 0.0 ? 1.0 : -1.0;
    add({0.0, side}, {std::clamp(there.x(), -l, l), side * w});
  }
  return sides;
}

}  // namespace v2vouch::sim
