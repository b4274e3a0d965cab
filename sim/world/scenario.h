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
#include "sim/world/radio_specs.h"
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

struct WaypointSpec {
  double x_m = 0.0;
  double y_m = 0.0;
  double radius_m = 10.0;  ///< Smallest radius of the curve round this corner.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("x_m", x_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("y_m", y_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("radius_m", radius_m, {.at_least = 2.0, .at_most = 1e5});
  }
};

/// A named line that vehicles follow. Distances along it count from its first waypoint.
struct RouteSpec {
  std::string name;
  std::vector<WaypointSpec> waypoints;
  double centre_m = 0.0;  ///< The road's centre line, from the route, left positive; 0 = not known.

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("name", name);
    a.Field("waypoints", waypoints);
    a.Field("centre_m", centre_m, {.at_least = -100.0, .at_most = 100.0});
  }
};

struct StopSpec {
  double at_m = 0.0;     ///< Where the front bumper comes to rest, along the route.
  double until_s = 0.0;  ///< Stands until then; ignored when reached later.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("at_m", at_m, {.at_least = -1e4, .at_most = 1e5});
    a.Field("until_s", until_s, {.at_least = 0.0, .at_most = 1e5});
  }
};

struct SpeedSpec {
  double from_s = 0.0;  ///< From this time on ...
  double mps = 10.0;    ///< ... this is the speed to reach.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("from_s", from_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("mps", mps, {.at_least = 0.0, .at_most = 70.0});
  }
};

struct LaneChangeSpec {
  double at_s = 0.0;      ///< Start.
  double over_s = 4.0;    ///< How long it takes.
  double offset_m = 0.0;  ///< Lateral offset from the route afterwards, left positive.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("at_s", at_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("over_s", over_s, {.at_least = 1.0, .at_most = 60.0});
    a.Field("offset_m", offset_m, {.at_least = -50.0, .at_most = 50.0});
  }
};

/// How a vehicle drives along its route. A simple driver holds the speed asked for, slows for bends
/// and stops; the result is smoothed over one second, so that acceleration never jumps.
struct DriveSpec {
  std::string route;
  double start_m = 0.0;   ///< Centre of the footprint along the route at time 0.
  double offset_m = 0.0;  ///< Lateral offset from the route, left positive.
  double speed_mps = 13.0;
  double accel_mps2 = 1.8;
  double decel_mps2 = 2.2;
  bool reverse = false;             ///< Drives backwards: the front looks back along the route.
  double lateral_mps2 = 2.2;        ///< Bends are taken no faster than this allows.
  std::vector<SpeedSpec> speeds{};  ///< Later wishes, in order of time.
  std::vector<StopSpec> stops{};    ///< In order of distance.
  std::vector<LaneChangeSpec> lane_changes{};

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("route", route);
    a.Field("start_m", start_m, {.at_least = -1e4, .at_most = 1e5});
    a.Field("offset_m", offset_m, {.at_least = -50.0, .at_most = 50.0});
    a.Field("speed_mps", speed_mps, {.at_least = 0.0, .at_most = 70.0});
    a.Field("accel_mps2", accel_mps2, {.above = 0.0, .at_most = 8.0});
    a.Field("decel_mps2", decel_mps2, {.above = 0.0, .at_most = 9.0});
    a.Field("reverse", reverse);
    a.Field("lateral_mps2", lateral_mps2, {.above = 0.0, .at_most = 8.0});
    a.Field("speeds", speeds);
    a.Field("stops", stops);
    a.Field("lane_changes", lane_changes);
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

/// A house: a rectangle, or any outline (x, y, x, y, ... counter-clockwise) where given.
struct BuildingSpec {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double length_m = 20.0;
  double width_m = 15.0;
  double height_m = 12.0;
  std::vector<double> outline{};

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("x_m", x_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("y_m", y_m, {.at_least = -1e5, .at_most = 1e5});
    a.Degrees("yaw_deg", yaw_rad, {.at_least = -360.0, .at_most = 360.0});
    a.Field("length_m", length_m, {.above = 0.0, .at_most = 1e4});
    a.Field("width_m", width_m, {.above = 0.0, .at_most = 1e4});
    a.Field("height_m", height_m, {.above = 0.0, .at_most = 500.0});
    a.Field("outline", outline);
  }
};

/// Lamp post, traffic light, tree: one strong return, hides nothing.
struct PoleSpec {
  double x_m = 0.0;
  double y_m = 0.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("x_m", x_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("y_m", y_m, {.at_least = -1e5, .at_most = 1e5});
  }
};

/// A straight row of poles, both ends included.
struct PoleRowSpec {
  double from_x_m = 0.0;
  double from_y_m = 0.0;
  double to_x_m = 0.0;
  double to_y_m = 0.0;
  double every_m = 20.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("from_x_m", from_x_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("from_y_m", from_y_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("to_x_m", to_x_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("to_y_m", to_y_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("every_m", every_m, {.at_least = 1.0, .at_most = 1e4});
  }
};

/// Guard rail beside a route: posts every 2 m, a mirror for radar, hides nothing.
struct RailSpec {
  std::string route;
  double offset_m = 0.0;  ///< From the route, left positive.
  double from_m = 0.0;    ///< Along the route.
  double to_m = 100.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("route", route);
    a.Field("offset_m", offset_m, {.at_least = -100.0, .at_most = 100.0});
    a.Field("from_m", from_m, {.at_least = -1e4, .at_most = 1e5});
    a.Field("to_m", to_m, {.at_least = -1e4, .at_most = 1e5});
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
