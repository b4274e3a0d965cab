// SPDX-License-Identifier: Apache-2.0
#include "sim/world/scenario.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/rim/config/yaml_writer.h"
#include "sim/world/mounting.h"

namespace v2vouch::sim {

bool CheckReferences(const Scenario& scenario, std::vector<std::string>& problems) {
  const std::size_t before = problems.size();
  std::set<std::string> routes;
  for (const RouteSpec& route : scenario.routes) {
    if (!routes.insert(route.name).second) problems.push_back("routes: " + route.name + " twice");
  }
  const auto need = [&](const std::string& name, const std::string& who) {
    if (routes.contains(name)) return;
    problems.push_back(who + ": no route is called '" + name + "'" +
                       DidYouMean(name, std::vector<std::string>(routes.begin(), routes.end())));
  };
  if (scenario.ego.trajectory_id == 0) need(scenario.ego.drive.route, "ego.drive.route");
  if (scenario.ego.trajectory_id != 0 && scenario.trajectories.empty()) {
    problems.push_back("ego.trajectory_id needs `trajectories`");
  }
  std::set<std::uint32_t> ids;
  for (const VehicleSpec& vehicle : scenario.vehicles) {
    const std::string who = "vehicle " + std::to_string(vehicle.id);
    if (!ids.insert(vehicle.id).second) problems.push_back(who + ": id is taken");
    need(vehicle.drive.route, who);
  }
  for (const ParkedSpec& parked : scenario.parked) {
    if (!ids.insert(parked.id).second) {
      problems.push_back("parked " + std::to_string(parked.id) + ": id is taken");
    }
  }
  double weights = 0.0;
  for (const TrafficLaneSpec& lane : scenario.traffic.lanes) {
    need(lane.route, "traffic.lanes");
    weights += lane.weight;
    if (lane.to_m < lane.from_m) problems.push_back("traffic.lanes: to_m is less than from_m");
  }
  if (scenario.traffic.vehicles > 0 && weights <= 0.0) {
    problems.push_back("traffic.vehicles: `traffic.lanes` names no lane with a weight");
  }
  for (const RailSpec& rail : scenario.rails) need(rail.route, "rails");
  CheckMounting(scenario, problems);
  for (const BuildingSpec& building : scenario.buildings) {
    if (!building.outline.empty() &&
        (building.outline.size() < 6 || building.outline.size() % 2 != 0)) {
      problems.push_back("buildings: outline needs x, y of three corners at least");
    }
  }
  for (std::size_t i = 0; i < scenario.attacks.size(); ++i) {
    CheckAttack(scenario.attacks[i], "attacks[" + std::to_string(i) + "]", problems);
    for (const std::uint32_t id : scenario.attacks[i].who.vehicles) {
      const auto it = std::find_if(scenario.vehicles.begin(), scenario.vehicles.end(),
                                   [id](const VehicleSpec& v) { return v.id == id; });
      if (it != scenario.vehicles.end() ? !it->v2v : scenario.trajectories.empty()) {
        problems.push_back("attacks[" + std::to_string(i) + "].who.vehicles: no vehicle " +
                           std::to_string(id) + " that talks");
      }
    }
  }
  return problems.size() == before;
}

Size UsualSize(ObjectClass object_class) {
  switch (object_class) {
    case ObjectClass::kVan:
      return {5.4, 2.0, 2.3};
    case ObjectClass::kTruck:
      return {12.0, 2.5, 3.6};
    case ObjectClass::kBus:
      return {12.0, 2.55, 3.2};
    case ObjectClass::kMotorcycle:
      return {2.2, 0.8, 1.4};
    case ObjectClass::kPedestrian:
      return {0.5, 0.5, 1.75};
    case ObjectClass::kCyclist:
      return {1.8, 0.6, 1.75};
    default:
      return {4.5, 1.8, 1.5};
  }
}

bool LoadScenario(const std::string& path, Scenario& scenario, std::vector<std::string>& problems) {
  const std::size_t before = problems.size();
  scenario.folder = std::filesystem::path(path).parent_path().string();
  if (!config::Load(path, scenario, problems)) return false;
  CheckReferences(scenario, problems);
  for (std::size_t i = before; i < problems.size(); ++i) problems[i] = path + ": " + problems[i];
  return problems.size() == before;
}

std::string ToYaml(const Scenario& scenario) { return config::Print(scenario); }

}  // namespace v2vouch::sim
