// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/usual_reflections.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::sim {

double UsualRcs(ObjectClass object_class) {
  switch (object_class) {
    case ObjectClass::kTruck:
    case ObjectClass::kBus:
      return 18.0;
    case ObjectClass::kVan:
      return 12.0;
    case ObjectClass::kMotorcycle:
      return 3.0;
    case ObjectClass::kPedestrian:
    case ObjectClass::kCyclist:
      return -3.0;
    default:
      return 9.0;
  }
}

double MeanReflections(ObjectClass object_class, double range_m) {
  const double car = 2.0 + 6.0 * std::max(0.0, 1.0 - range_m / 80.0);
  switch (object_class) {
    case ObjectClass::kTruck:
    case ObjectClass::kBus:
      return 1.6 * car;
    case ObjectClass::kMotorcycle:
    case ObjectClass::kCyclist:
      return std::max(1.0, 0.4 * car);
    case ObjectClass::kPedestrian:
      return 1.0;
    default:
      return car;
  }
}

std::vector<Spot> StrongSpots(const Box& box, const Vec2& antenna) {
  const double l = 0.5 * box.length_m;
  const double w = 0.5 * box.width_m;
  const Vec2 from = box.Local(antenna);
  std::vector<Spot> spots;
  const double side = from.y() > 0.0 ? 1.0 : -1.0;
  const double end = from.x() > 0.0 ? 1.0 : -1.0;
  const bool sees_side = std::abs(from.y()) > w;
  const bool sees_end = std::abs(from.x()) > l;
  const auto add = [&](double x, double y, double weight) {
    spots.push_back({box.PointAt(x, y), weight});
  };
  // Corners are rounded, so their reflection sits a little inside.
  const double inset = std::min({0.15, 0.3 * l, 0.3 * w});
  if (sees_end) {
    add(end * l, 0.0, 1.5);  // Number plate, grille, tail gate.
    add(end * (l - inset), w - inset, 1.0);
    add(end * (l - inset), -(w - inset), 1.0);
  }
  if (sees_side) {
    if (!sees_end) add(end * (l - inset), side * (w - inset), 1.0);
    add(-end * (l - inset), side * (w - inset), 0.7);
    add(0.3 * box.length_m, side * (w - inset), 1.2);  // Wheel houses.
    add(-0.3 * box.length_m, side * (w - inset), 1.2);
    for (double x = -l + 2.0; box.length_m > 7.0 && x < l - 2.0; x += 2.5) {
      add(x, side * w, 0.4);  // Frame and tanks of long vehicles.
    }
  }
  return spots;
}

Scenery SceneryOf(const World& world) {
  Scenery scenery;
  for (const Wall& wall : world.walls()) {
    for (std::size_t i = 0; i < wall.outline.size(); ++i) {
      const Vec2& a = wall.outline[i];
      const Vec2& b = wall.outline[(i + 1) % wall.outline.size()];
      const double length = (b - a).norm();
      const Vec2 normal = -LeftOf((b - a) / length);  // Outwards: the outline is counter-clockwise.
      scenery.scatterers.push_back({a, Vec2::Zero(), 12.0, 0.8});
      for (double s = 1.0; s < length; s += 2.0) {  // Window frames, pipes, door steps.
        scenery.scatterers.push_back({a + (b - a) * (s / length), normal, 6.0, 0.6});
      }
      scenery.mirrors.emplace_back(a, b);
    }
  }
  for (const Vec2& pole : world.poles())
    scenery.scatterers.push_back({pole, Vec2::Zero(), 4.0, 0.95});
  for (const Rail& rail : world.rails()) {
    for (std::size_t i = 0; i < rail.points.size(); ++i) {
      scenery.scatterers.push_back({rail.points[i], Vec2::Zero(), 2.0, 0.6});
      if (i > 0) scenery.mirrors.emplace_back(rail.points[i - 1], rail.points[i]);
    }
  }
  return scenery;
}

}  // namespace v2vouch::sim
