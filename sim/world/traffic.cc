// SPDX-License-Identifier: Apache-2.0
#include "sim/world/traffic.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/random.h"

namespace v2vouch::sim {
namespace {

constexpr std::uint64_t kSubjectTraffic = 0x5472616666696373ull;
constexpr double kStep_s = 0.2;
constexpr int kTries = 300;        // In a row, before the lanes count as full.
constexpr double kBeside_m = 0.3;  // Free space on either side, less than any two lanes leave.
constexpr double kNearSector_rad = kPi / 6.0;

// Footprints of one vehicle every kStep_s; those of a moment when it is not there are nowhere.
using Way = std::vector<Box>;

constexpr double kNowhere_m = 1e12;

Way WayOf(const Trajectory& trajectory, double length_m, double width_m, std::size_t steps) {
  Way way(steps);
  for (std::size_t i = 0; i < steps; ++i) {
    const double time = static_cast<double>(i) * kStep_s;
    way[i] = {Vec2(kNowhere_m, kNowhere_m), 0.0, length_m, width_m};
    if (!trajectory.Exists(time)) continue;
    const Motion motion = trajectory.At(time);
    way[i].centre = motion.centre;
    way[i].yaw_rad = motion.yaw_rad;
  }
  return way;
}

// The same at the lane's speed all the way, whatever bends say: what most lanes come to, and cheap.
Way SteadyWay(const VehicleSpec& spec, const Path& path, std::size_t steps) {
  Way way(steps);
  for (std::size_t i = 0; i < steps; ++i) {
    const double time = static_cast<double>(i) * kStep_s;
    const PathPoint point = path.At(spec.drive.start_m + spec.drive.speed_mps * time);
    way[i] = {point.position + spec.drive.offset_m * LeftOf(Direction(point.yaw_rad)),
              point.yaw_rad, spec.length_m, spec.width_m};
  }
  return way;
}

bool AreApart(const Way& a, const Way& b, double gap_m) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double reach = 0.5 * (a[i].length_m + b[i].length_m + a[i].width_m + b[i].width_m);
    if ((a[i].centre - b[i].centre).norm() > reach + gap_m + 1.0) continue;
    Box wide = a[i];
    wide.length_m += 2.0 * gap_m;
    wide.width_m += 2.0 * kBeside_m;
    if (Overlap(wide, b[i])) return false;
  }
  return true;
}

double NearFor_s(const Way& way, const Way& ego, double near_m) {
  double seconds = 0.0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const Vec2 d = way[i].centre - ego[i].centre;
    const double bearing = AngleDifference(std::atan2(d.y(), d.x()), ego[i].yaw_rad);
    if (d.norm() <= near_m && std::abs(bearing) <= kNearSector_rad) seconds += kStep_s;
  }
  return seconds;
}

const TrafficLaneSpec& DrawLane(const std::vector<TrafficLaneSpec>& lanes, Random& random) {
  double total = 0.0;
  for (const TrafficLaneSpec& lane : lanes) total += lane.weight;
  double draw = random.Uniform(0.0, total);
  std::size_t chosen = 0;
  while (chosen + 1 < lanes.size() && draw >= lanes[chosen].weight) draw -= lanes[chosen++].weight;
  return lanes[chosen];
}

VehicleSpec DrawVehicle(const TrafficSpec& traffic, Random& random) {
  const TrafficLaneSpec& lane = DrawLane(traffic.lanes, random);
  VehicleSpec spec;
  spec.drive.route = lane.route;
  spec.drive.offset_m = lane.offset_m;
  spec.drive.speed_mps = lane.speed_mps;
  spec.drive.start_m = random.Uniform(lane.from_m, lane.to_m);
  const double kind = random.Uniform();
  const double light = random.Uniform();
  const double bus_share = traffic.bus_share > 0.0 ? traffic.bus_share : lane.bus_share;
  if (kind < lane.truck_share) {
    spec.object_class = ObjectClass::kTruck;
  } else if (kind < lane.truck_share + bus_share) {
    spec.object_class = ObjectClass::kBus;
  } else if (light < traffic.van_share) {
    spec.object_class = ObjectClass::kVan;
  } else if (light < traffic.van_share + traffic.motorcycle_share) {
    spec.object_class = ObjectClass::kMotorcycle;
  }
  const Size size = UsualSize(spec.object_class);
  spec.length_m = size.length_m;
  spec.width_m = size.width_m;
  const bool is_truck = spec.object_class == ObjectClass::kTruck;
  if (is_truck && traffic.truck_length_m > 0.0) spec.length_m = traffic.truck_length_m;
  const bool is_bus = spec.object_class == ObjectClass::kBus;
  if (is_bus && traffic.bus_length_m > 0.0) spec.length_m = traffic.bus_length_m;
  spec.v2v = random.Bernoulli(traffic.v2v_share);
  return spec;
}

}  // namespace

bool AddTraffic(const Scenario& scenario, const std::map<std::string, Path>& paths,
                const Trajectory& ego, double duration_s, std::uint64_t seed,
                std::vector<Actor>& actors, std::vector<std::string>& problems) {
  const TrafficSpec& traffic = scenario.traffic;
  if (traffic.vehicles == 0) return true;
  const auto steps = static_cast<std::size_t>(duration_s / kStep_s) + 1;
  std::vector<Way> taken;
  taken.push_back(WayOf(ego, scenario.vehicle.length_m, scenario.vehicle.width_m, steps));
  for (const Actor& actor : actors) {
    taken.push_back(WayOf(actor.trajectory, actor.size.length_m, actor.size.width_m, steps));
  }
  Random random = Random::ForSubject(seed, kSubjectTraffic);
  int placed = 0;
  for (const double near_s : {traffic.near_s, 0.0}) {
    const auto fits = [&](const Way& way) {
      return NearFor_s(way, taken.front(), traffic.near_m) >= near_s &&
             std::all_of(taken.begin(), taken.end(),
                         [&](const Way& other) { return AreApart(way, other, traffic.gap_m); });
    };
    for (int tries = kTries; placed < traffic.vehicles && tries > 0; --tries) {
      VehicleSpec spec = DrawVehicle(traffic, random);
      const Path& path = paths.at(spec.drive.route);
      if (!fits(SteadyWay(spec, path, steps))) continue;
      spec.id = kFirstTrafficId + static_cast<std::uint32_t>(placed);
      Actor actor = MakeDriven(spec, path, duration_s);
      Way way = WayOf(actor.trajectory, actor.size.length_m, actor.size.width_m, steps);
      if (!fits(way)) continue;
      taken.push_back(std::move(way));
      actors.push_back(std::move(actor));
      ++placed;
      tries = kTries + 1;
    }
  }
  if (placed == traffic.vehicles) return true;
  problems.push_back("traffic.vehicles = " + std::to_string(traffic.vehicles) +
                     ": the lanes have room for " + std::to_string(placed) +
                     " only (longer or more lanes or a smaller gap_m make room)");
  return false;
}

}  // namespace v2vouch::sim
