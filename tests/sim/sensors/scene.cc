// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/sensors/scene.h"

#include <gtest/gtest.h>

namespace v2vouch::sim {

Scenario StandingEgo() {
  Scenario scenario;
  scenario.name = "scene";
  scenario.duration_s = 60.0;
  scenario.routes.push_back({"ego", {{0.0, 0.0, 10.0}, {1000.0, 0.0, 10.0}}});
  scenario.ego.drive.route = "ego";
  scenario.ego.drive.start_m = scenario.vehicle.centre_x_m;
  scenario.ego.drive.speed_mps = 0.0;
  return scenario;
}

void AddVehicle(Scenario& scenario, std::uint32_t id, double x_m, double y_m, double yaw_rad,
                double speed_mps, ObjectClass object_class) {
  const std::string route = "route" + std::to_string(id);
  const Vec2 way = 1000.0 * Direction(yaw_rad);
  scenario.routes.push_back({route, {{x_m, y_m, 10.0}, {x_m + way.x(), y_m + way.y(), 10.0}}});
  VehicleSpec vehicle;
  vehicle.id = id;
  vehicle.object_class = object_class;
  vehicle.drive.route = route;
  vehicle.drive.speed_mps = speed_mps;
  scenario.vehicles.push_back(vehicle);
}

std::unique_ptr<World> MakeWorld(const Scenario& scenario, std::uint64_t seed) {
  std::vector<std::string> problems;
  auto world = World::Make(scenario, seed, problems);
  for (const std::string& problem : problems) ADD_FAILURE() << problem;
  return world;
}

}  // namespace v2vouch::sim
