// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"
#include "daemon/common/data/object_class.h"
#include "daemon/common/data/vehicle.h"
#include "sim/world/attack_spec.h"
#include "sim/world/drive_spec.h"
#include "sim/world/radio_specs.h"
#include "sim/world/scenery_spec.h"
#include "sim/world/sensor_family.h"
#include "sim/world/sensor_specs.h"
#include "sim/world/traffic_spec.h"

/// The scenario file as plain structs. Every section is a struct with a Visit list, so that
/// reading, checking and printing share one list and a new section (an attack, a condition) is one
/// more struct. World frame W: plane touching the ellipsoid at `origin`, x east, y north [m];
/// directions counter-clockwise from east.
namespace v2vouch::sim {

struct OriginSpec {
  double latitude_rad = FromDegrees(50.938);
  double longitude_rad = FromDegrees(6.957);
  double height_m = 100.0;  ///< Of the road above the ellipsoid.

  template <class Archive>
  void Visit(Archive& a) {
    a.Degrees("latitude_deg", latitude_rad, {.at_least = -89.0, .at_most = 89.0});
    a.Degrees("longitude_deg", longitude_rad, {.at_least = -180.0, .at_most = 180.0});
    a.Field("height_m", height_m, {.at_least = -400.0, .at_most = 6000.0});
  }
};

struct EgoSpec {
  DriveSpec drive;
  std::uint32_t trajectory_id = 0;  ///< With `trajectories`: the row id that is the ego; 0 = drive.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("drive", drive);
    a.Field("trajectory_id", trajectory_id, {});
  }
};

/// A moving or standing road user. Sizes of 0 take the class's usual ones.
struct VehicleSpec {
  std::uint32_t id = 0;  ///< Unique, above 0.
  ObjectClass object_class = ObjectClass::kCar;
  double length_m = 0.0;
  double width_m = 0.0;
  double height_m = 0.0;
  bool v2v = false;  ///< Sends BSMs.
  DriveSpec drive;
  SenderSpec sender;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("id", id, {.at_least = 1, .at_most = 4e9});
    VisitObjectClass(a, object_class);
    a.Field("length_m", length_m, {.at_least = 0.0, .at_most = 30.0});
    a.Field("width_m", width_m, {.at_least = 0.0, .at_most = 4.0});
    a.Field("height_m", height_m, {.at_least = 0.0, .at_most = 5.0});
    a.Field("v2v", v2v);
    a.Field("drive", drive);
    a.Field("sender", sender);
  }
};

/// A parked vehicle; it is in the truth like any other.
struct ParkedSpec {
  std::uint32_t id = 0;
  ObjectClass object_class = ObjectClass::kCar;
  double x_m = 0.0;  ///< Centre of the footprint.
  double y_m = 0.0;
  double yaw_rad = 0.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("id", id, {.at_least = 1, .at_most = 4e9});
    VisitObjectClass(a, object_class);
    a.Field("x_m", x_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("y_m", y_m, {.at_least = -1e5, .at_most = 1e5});
    a.Degrees("yaw_deg", yaw_rad, {.at_least = -360.0, .at_most = 360.0});
  }
};

/// How many of the parked vehicles talk, and how.
struct ParkedSendersSpec {
  double share = 0.0;  ///< Drawn per vehicle.
  SenderSpec sender;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("share", share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("sender", sender);
  }
};

struct Scenario {
  std::string name;
  std::string description;
  double duration_s = 30.0;
  std::uint32_t start_utc_s = 1781510400;  ///< Time 0, seconds UTC; default 2026-06-15 08:00:00.
  OriginSpec origin;
  std::vector<RouteSpec> routes;
  EgoSpec ego;
  std::vector<VehicleSpec> vehicles;
  TrafficSpec traffic;
  /// CSV of recorded or imported motion, beside this file. Columns time_s, id, class, x_m, y_m,
  /// yaw_rad, speed_mps, length_m, width_m; world frame, centre of the footprint.
  std::string trajectories;
  double v2v_share = 0.0;  ///< Of the vehicles in `trajectories`, drawn per id.
  std::vector<ParkedSpec> parked;
  ParkedSendersSpec parked_senders;
  std::vector<BuildingSpec> buildings;
  std::vector<PoleSpec> poles;
  std::vector<PoleRowSpec> pole_rows;
  std::vector<RailSpec> rails;
  VehicleConfig
      vehicle;  ///< The ego car: body and sensors, as the daemon's configuration has them.
  std::vector<MountingErrorSpec> mounting;  ///< Where they sit otherwise.
  SensorsSpec sensors;
  std::optional<FamilySpec> family;  ///< Of modes other than realistic and ideal_points.
  BsmSpec bsm;
  RadioSpec radio;
  EgoGnssSpec gnss;
  OdometrySpec odometry;
  std::vector<AttackSpec> attacks;
  std::vector<std::string> overlays;  ///< Names of what was laid over it, in order (overlay.h).

  std::string folder{};  ///< Of the file it came from; not in the file.

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("name", name);
    a.Text("description", description);
    a.Field("duration_s", duration_s, {.above = 0.0, .at_most = 86400.0});
    a.Field("start_utc_s", start_utc_s, {});
    a.Field("origin", origin);
    a.Field("routes", routes);
    a.Field("ego", ego);
    a.Field("vehicles", vehicles);
    a.Field("traffic", traffic);
    a.Text("trajectories", trajectories);
    a.Field("v2v_share", v2v_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("parked", parked);
    a.Field("parked_senders", parked_senders);
    a.Field("buildings", buildings);
    a.Field("poles", poles);
    a.Field("pole_rows", pole_rows);
    a.Field("rails", rails);
    a.Field("vehicle", vehicle);
    a.Field("mounting", mounting);
    a.Field("sensors", sensors);
    a.Field("family", family);
    a.Field("bsm", bsm);
    a.Field("radio", radio);
    a.Field("gnss", gnss);
    a.Field("odometry", odometry);
    a.Field("attacks", attacks);
    a.Field("overlays", overlays);
  }
};

/// Usual size of a class [m].
struct Size {
  double length_m = 4.5;
  double width_m = 1.8;
  double height_m = 1.5;
};
Size UsualSize(ObjectClass object_class);

/// Reads and checks a scenario file. Every problem found goes to `problems`, one line each.
/// @return false when there is any.
bool LoadScenario(const std::string& path, Scenario& scenario, std::vector<std::string>& problems);

/// Whether ids are unique, routes named exist, and the like: what no single key can tell.
/// @return false with one problem per fault.
bool CheckReferences(const Scenario& scenario, std::vector<std::string>& problems);

/// The effective scenario, every default spelled out, as YAML that LoadScenario takes again.
std::string ToYaml(const Scenario& scenario);

}  // namespace v2vouch::sim
