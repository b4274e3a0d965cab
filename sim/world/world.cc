// SPDX-License-Identifier: Apache-2.0
#include "sim/world/world.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "daemon/common/base/random.h"
#include "sim/world/draw_sensors.h"
#include "sim/world/mounting.h"
#include "sim/world/traffic.h"

namespace v2vouch::sim {
namespace {

constexpr double kPostSpacing_m = 2.0;
// Each of a vehicle's draws has a subject of its own: this plus its id.
constexpr std::uint64_t kSubjectV2vShare = 0x5632565368617265ull;
constexpr std::uint64_t kSubjectParkedShare = 0x5061726B65640000ull;
constexpr std::uint64_t kSubjectIdentity = 0x4964656E74690000ull;

std::map<std::string, Path> MakePaths(const Scenario& scenario,
                                      std::vector<std::string>& problems) {
  std::map<std::string, Path> paths;
  for (const RouteSpec& route : scenario.routes) {
    std::vector<Waypoint> waypoints;
    for (const WaypointSpec& w : route.waypoints) waypoints.push_back({{w.x_m, w.y_m}, w.radius_m});
    std::string problem;
    if (!Path::Make(waypoints, paths[route.name], problem)) {
      problems.push_back("routes: " + route.name + ": " + problem);
    }
  }
  return paths;
}

Wall MakeWall(const BuildingSpec& building) {
  Wall wall;
  wall.height_m = building.height_m;
  if (building.outline.empty()) {
    const Box box{
        {building.x_m, building.y_m}, building.yaw_rad, building.length_m, building.width_m};
    const auto corners = box.Corners();
    wall.outline.assign(corners.begin(), corners.end());
    return wall;
  }
  for (std::size_t i = 0; i + 1 < building.outline.size(); i += 2) {
    wall.outline.emplace_back(building.outline[i], building.outline[i + 1]);
  }
  double twice_area = 0.0;
  for (std::size_t i = 0; i < wall.outline.size(); ++i) {
    twice_area += Cross(wall.outline[i], wall.outline[(i + 1) % wall.outline.size()]);
  }
  if (twice_area < 0.0) std::reverse(wall.outline.begin(), wall.outline.end());
  return wall;
}

Rail MakeRail(const RailSpec& spec, const Path& path) {
  Rail rail;
  for (double s = spec.from_m; s <= spec.to_m; s += kPostSpacing_m) {
    const PathPoint point = path.At(s);
    rail.points.push_back(point.position + spec.offset_m * LeftOf(Direction(point.yaw_rad)));
  }
  return rail;
}

Actor MakeParked(const ParkedSpec& spec, const ParkedSendersSpec& senders, std::uint64_t seed) {
  Actor actor;
  actor.id = spec.id;
  actor.object_class = spec.object_class;
  actor.size = UsualSize(spec.object_class);
  actor.has_v2v = Random::ForSubject(seed, kSubjectParkedShare + spec.id).Bernoulli(senders.share);
  actor.sender = senders.sender;
  actor.trajectory = Trajectory::Stand({spec.x_m, spec.y_m}, spec.yaw_rad);
  return actor;
}

Actor MakeRecorded(std::uint32_t id, const Recorded& vehicle, double v2v_share,
                   std::uint64_t seed) {
  Actor actor;
  actor.id = id;
  actor.object_class = vehicle.object_class;
  actor.size = {vehicle.length_m, vehicle.width_m, UsualSize(vehicle.object_class).height_m};
  actor.has_v2v = Random::ForSubject(seed, kSubjectV2vShare + id).Bernoulli(v2v_share);
  actor.trajectory = Trajectory::Follow(vehicle.rows);
  return actor;
}

// The vehicles of the trajectory file, by id.
std::map<std::uint32_t, Recorded> LoadRecorded(const Scenario& scenario,
                                               std::vector<std::string>& problems) {
  std::map<std::uint32_t, Recorded> recorded;
  if (!scenario.trajectories.empty()) {
    const std::filesystem::path file(scenario.trajectories);
    LoadTrajectories(file.is_absolute() ? file.string()
                                        : (std::filesystem::path(scenario.folder) / file).string(),
                     recorded, problems);
  }
  return recorded;
}

// Sorts by id. @return false when two vehicles share one.
bool SortById(std::vector<Actor>& actors, std::vector<std::string>& problems) {
  std::sort(actors.begin(), actors.end(),
            [](const Actor& a, const Actor& b) { return a.id < b.id; });
  for (std::size_t i = 1; i < actors.size(); ++i) {
    if (actors[i].id == actors[i - 1].id) {
      problems.push_back("vehicle id " + std::to_string(actors[i].id) + " is taken twice");
      return false;
    }
  }
  return true;
}

void DrawIdentityChanges(const BsmSpec& bsm, std::uint64_t seed, std::vector<Actor>& actors) {
  for (Actor& actor : actors) {
    if (bsm.identity_change_s + bsm.identity_change_spread_s <= 0.0) break;
    if (actor.sender.identity_change_s > 0.0) continue;
    const double lot = Random::ForSubject(seed, kSubjectIdentity + actor.id).Uniform();
    actor.sender.identity_change_s = bsm.identity_change_s + lot * bsm.identity_change_spread_s;
  }
}

std::vector<Vec2> MakePoles(const Scenario& scenario) {
  std::vector<Vec2> poles;
  for (const PoleSpec& pole : scenario.poles) poles.emplace_back(pole.x_m, pole.y_m);
  for (const PoleRowSpec& row : scenario.pole_rows) {
    const Vec2 from(row.from_x_m, row.from_y_m);
    const Vec2 way = Vec2(row.to_x_m, row.to_y_m) - from;
    const int spaces = std::max(1, static_cast<int>(std::lround(way.norm() / row.every_m)));
    for (int i = 0; i <= spaces; ++i) {
      poles.push_back(from + way * (static_cast<double>(i) / spaces));
    }
  }
  return poles;
}

}  // namespace

Vec2 EgoTruth::PointAt(double x_m, double y_m) const {
  const Vec2 forward = Direction(yaw_rad);
  return axle + x_m * forward + y_m * LeftOf(forward);
}

Vec2 EgoTruth::VelocityAt(const Vec2& point) const {
  return speed_mps * Direction(yaw_rad) + yaw_rate_radps * LeftOf(point - axle);
}

World::World(const Scenario& scenario) : scenario_(scenario), vehicle_(Mounted(scenario)) {}

std::unique_ptr<World> World::Make(const Scenario& given, std::uint64_t seed,
                                   std::vector<std::string>& problems) {
  const std::size_t before = problems.size();
  Scenario scenario = given;
  DrawSensors(seed, scenario);
  std::unique_ptr<World> world(new World(scenario));
  const auto paths = MakePaths(scenario, problems);
  const auto recorded = LoadRecorded(scenario, problems);
  const std::uint32_t ego_id = scenario.ego.trajectory_id;
  if (ego_id != 0 && !recorded.contains(ego_id)) {
    problems.push_back("ego.trajectory_id: no vehicle " + std::to_string(ego_id) + " in " +
                       scenario.trajectories);
  }
  if (problems.size() != before) return nullptr;

  const double duration = scenario.duration_s + 1.0;
  if (ego_id != 0) {
    world->ego_ = Trajectory::Follow(recorded.at(ego_id).rows);
  } else {
    const DriveSpec& drive = scenario.ego.drive;
    world->ego_ = Trajectory::Drive(paths.at(drive.route), drive, scenario.vehicle.length_m,
                                    scenario.vehicle.centre_x_m, duration);
  }
  for (const VehicleSpec& spec : scenario.vehicles) {
    world->actors_.push_back(MakeDriven(spec, paths.at(spec.drive.route), duration));
  }
  for (const ParkedSpec& spec : scenario.parked) {
    world->actors_.push_back(MakeParked(spec, scenario.parked_senders, seed));
  }
  for (const auto& [id, vehicle] : recorded) {
    if (id == ego_id) continue;
    world->actors_.push_back(MakeRecorded(id, vehicle, scenario.v2v_share, seed));
  }
  if (!AddTraffic(scenario, paths, world->ego_, duration, seed, world->actors_, problems)) {
    return nullptr;
  }
  if (!SortById(world->actors_, problems)) return nullptr;
  DrawIdentityChanges(scenario.bsm, seed, world->actors_);
  for (const BuildingSpec& building : scenario.buildings) {
    world->walls_.push_back(MakeWall(building));
  }
  world->poles_ = MakePoles(scenario);
  for (const RailSpec& rail : scenario.rails) {
    world->rails_.push_back(MakeRail(rail, paths.at(rail.route)));
  }
  return world;
}

Snapshot World::At(double time_s) const {
  Snapshot snapshot;
  snapshot.time_s = time_s;
  const Motion centre = ego_.At(time_s);
  EgoTruth& ego = snapshot.ego;
  ego.yaw_rad = centre.yaw_rad;
  ego.yaw_rate_radps = centre.yaw_rate_radps;
  ego.axle = centre.centre - scenario_.vehicle.centre_x_m * Direction(centre.yaw_rad);
  ego.speed_mps = centre.speed_mps;  // The same for every point of the body's x axis.
  ego.accel_mps2 = centre.accel_mps2;
  for (const Actor& actor : actors_) {
    if (actor.trajectory.Exists(time_s)) {
      snapshot.actors.push_back({&actor, actor.trajectory.At(time_s)});
    }
  }
  return snapshot;
}

}  // namespace v2vouch::sim
