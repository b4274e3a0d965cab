// SPDX-License-Identifier: Apache-2.0
#include "sim/import/sumo_scenario.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"
#include "daemon/common/data/object_class.h"
#include "daemon/common/data/vehicle.h"
#include "sim/import/drive_on.h"
#include "sim/import/intersection.h"

namespace v2vouch::sim {
namespace {

constexpr double kKeepWithin_m = 150.0;  // Of the ego, at any moment of the cut.
constexpr double kShortest_s = 5.0;
// Fits into the gap that SUMO leaves behind a 4.3 m car.
constexpr FcdBody kTallVan{ObjectClass::kVan, 5.4, 2.1};

__attribute__((format(printf, 2, 3))) void Append(std::string& text, const char* format, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  text += line;
}

// What SUMO does not say is a car.
std::string_view NameIn(ObjectClass object_class) {
  return ObjectClassName(object_class == ObjectClass::kUnknown ? ObjectClass::kCar : object_class);
}

// The part of the recording that becomes the scenario.
struct Cut {
  std::size_t ego = 0;
  double from_s = 0.0;
  double to_s = 0.0;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
};

bool ChooseCut(const std::vector<FcdVehicle>& vehicles, const std::vector<FcdBody>& bodies,
               const std::vector<std::vector<CentreSample>>& motions, const SumoOptions& options,
               Cut& cut, std::string& error) {
  std::optional<LeftTurn> turn;
  if (options.ego == "auto") {
    turn = BusiestLeftTurn(motions, bodies);
    if (!turn) {
      error = "no vehicle turns left with 8 s before and 4 s after; name one as the ego";
      return false;
    }
    cut.ego = turn->vehicle;
  } else {
    const auto found = std::find_if(vehicles.begin(), vehicles.end(),
                                    [&](const FcdVehicle& v) { return v.id == options.ego; });
    if (found == vehicles.end()) {
      error = "no vehicle has the id \"" + options.ego + "\"";
      return false;
    }
    cut.ego = static_cast<std::size_t>(found - vehicles.begin());
    turn = FindLeftTurn(motions, cut.ego);
  }
  const auto& own = motions[cut.ego];
  const double middle_s = turn ? turn->middle_s : 0.5 * (own.front().time_s + own.back().time_s);
  cut.from_s = std::max(own.front().time_s, middle_s - options.before_s);
  cut.to_s = std::min(own.back().time_s, middle_s + options.after_s);
  cut.origin = turn ? turn->middle : own[own.size() / 2].centre;
  if (cut.to_s - cut.from_s < kShortest_s) {
    error = "vehicle " + vehicles[cut.ego].id + " is recorded for less than 5 s of the cut";
    return false;
  }
  return true;
}

bool ComesNear(const std::vector<CentreSample>& motion, const std::vector<CentreSample>& ego,
               const Cut& cut) {
  for (const CentreSample& sample : motion) {
    if (sample.time_s < cut.from_s || sample.time_s > cut.to_s) continue;
    const auto own =
        std::lower_bound(ego.begin(), ego.end(), sample.time_s,
                         [](const CentreSample& a, double t_s) { return a.time_s < t_s; });
    if (own != ego.end() && (own->centre - sample.centre).norm() < kKeepWithin_m) return true;
  }
  return false;
}

void AppendRows(std::string& csv, std::size_t id, const FcdBody& body,
                const std::vector<CentreSample>& motion, const Cut& cut) {
  for (const CentreSample& sample : motion) {
    if (sample.time_s < cut.from_s || sample.time_s > cut.to_s) continue;
    const Eigen::Vector2d place = sample.centre - cut.origin;
    Append(csv, "%.3f,%zu,%s,%.4f,%.4f,%.6f,%.4f,%.2f,%.2f\n", sample.time_s - cut.from_s, id,
           std::string(NameIn(body.object_class)).c_str(), place.x(), place.y(), sample.yaw_rad,
           sample.speed_mps, body.length_m, body.width_m);
  }
}

// Latitude and longitude where the net frame's `place` is, by the ego's row nearest to it.
const FcdSample& NearestRow(const FcdVehicle& ego, const Eigen::Vector2d& place) {
  return *std::min_element(ego.samples.begin(), ego.samples.end(),
                           [&](const FcdSample& a, const FcdSample& b) {
                             return (a.front - place).norm() < (b.front - place).norm();
                           });
}

void AppendBuildings(std::string& yaml, const std::vector<CornerBuilding>& houses,
                     const Eigen::Vector2d& origin) {
  if (houses.empty()) return;
  yaml += "buildings:\n";
  for (const CornerBuilding& house : houses) {
    const Eigen::Vector2d place = house.centre - origin;
    Append(yaml, "  - {x_m: %.2f, y_m: %.2f, yaw_deg: %.2f, length_m: %.1f, width_m: %.1f}\n",
           place.x(), place.y(), ToDegrees(WrapAngle(house.yaw_rad)), house.length_m,
           house.width_m);
  }
  yaml += "poles:  # A lamp before each house.\n";
  for (const CornerBuilding& house : houses) {
    const Eigen::Vector2d inward = (origin - house.centre).normalized();
    const Eigen::Vector2d place = house.centre - origin + (0.5 * house.length_m + 6.0) * inward;
    Append(yaml, "  - {x_m: %.2f, y_m: %.2f}\n", place.x(), place.y());
  }
}

}  // namespace

bool MakeSumoScenario(const std::vector<FcdVehicle>& vehicles, const SumoOptions& options,
                      SumoScenario& scenario, std::string& error) {
  std::vector<FcdBody> bodies;
  std::vector<std::vector<CentreSample>> motions;
  for (std::size_t k = 0; k < vehicles.size(); ++k) {
    FcdBody body = BodyOfType(vehicles[k].type);
    if (body.object_class == ObjectClass::kCar &&
        Random::ForSubject(options.seed, k).Bernoulli(options.van_share)) {
      body = kTallVan;
    }
    bodies.push_back(body);
    motions.push_back(CentreMotion(vehicles[k], body));
  }
  Cut cut;
  if (!ChooseCut(vehicles, bodies, motions, options, cut, error)) return false;
  // The ego is the car that carries the sensors, whatever SUMO had in its place.
  const VehicleConfig car;
  bodies[cut.ego] = {ObjectClass::kCar, car.length_m, car.width_m};
  motions[cut.ego] = CentreMotion(vehicles[cut.ego], bodies[cut.ego]);
  // Sensors reach nearly as far as vehicles are kept: none may vanish before their eyes.
  DriveOn(motions, bodies, cut.ego, cut.to_s, kKeepWithin_m);

  scenario.trajectories_csv = "time_s,id,class,x_m,y_m,yaw_rad,speed_mps,length_m,width_m\n";
  AppendRows(scenario.trajectories_csv, 1, bodies[cut.ego], motions[cut.ego], cut);
  scenario.vehicles = 0;
  std::string names;
  for (std::size_t k = 0; k < vehicles.size(); ++k) {
    if (k == cut.ego || !ComesNear(motions[k], motions[cut.ego], cut)) continue;
    const std::size_t id = 2 + scenario.vehicles++;
    AppendRows(scenario.trajectories_csv, id, bodies[k], motions[k], cut);
    names += "#   " + std::to_string(id) + " = " + vehicles[k].id + "\n";
  }
  const auto houses = options.has_buildings
                          ? CornerBuildings(cut.origin, motions, options.setback_m)
                          : std::vector<CornerBuilding>{};
  const FcdSample& row = NearestRow(vehicles[cut.ego], cut.origin);
  scenario.ego = vehicles[cut.ego].id;
  scenario.duration_s = cut.to_s - cut.from_s;
  scenario.buildings = houses.size();

  scenario.yaml =
      "# Made by v2vouch-import sumo-fcd. Ids in the trajectories and SUMO's own:\n#   1 = " +
      scenario.ego + " (ego)\n" + names;
  scenario.yaml += "name: " + options.name + "\n";
  Append(scenario.yaml, "description: SUMO traffic from %.1f s to %.1f s\n", cut.from_s, cut.to_s);
  Append(scenario.yaml, "duration_s: %.3f\n", scenario.duration_s);
  Append(scenario.yaml, "origin: {latitude_deg: %.7f, longitude_deg: %.7f, height_m: 50.0}\n",
         row.latitude_deg, row.longitude_deg);
  scenario.yaml += "trajectories: trajectories.csv\n";
  scenario.yaml += "ego: {trajectory_id: 1}\n";
  Append(scenario.yaml, "v2v_share: %.3f\n", options.v2v_share);
  AppendBuildings(scenario.yaml, houses, cut.origin);
  return true;
}

}  // namespace v2vouch::sim
