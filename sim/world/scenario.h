// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/base/angle.h"
#include "daemon/base/visit.h"
#include "daemon/data/input.h"
#include "daemon/data/vehicle.h"

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

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("name", name);
    a.Field("waypoints", waypoints);
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

/// What sets one sender apart from the scenario's `bsm` section.
struct SenderSpec {
  double rate_hz = 0.0;      ///< 0 = as in `bsm`.
  double bias_east_m = 0.0;  ///< Added to the bias drawn.
  double bias_north_m = 0.0;
  double noise_scale = 1.0;  ///< Of all this sender's GNSS errors.
  double latency_scale = 1.0;
  double identity_change_s = 0.0;  ///< Takes a new TemporaryID and certificate then; 0 = never.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("rate_hz", rate_hz, {.at_least = 0.0, .at_most = 50.0});
    a.Field("bias_east_m", bias_east_m, {.at_least = -1e3, .at_most = 1e3});
    a.Field("bias_north_m", bias_north_m, {.at_least = -1e3, .at_most = 1e3});
    a.Field("noise_scale", noise_scale, {.at_least = 0.0, .at_most = 100.0});
    a.Field("latency_scale", latency_scale, {.at_least = 0.0, .at_most = 20.0});
    a.Field("identity_change_s", identity_change_s, {.at_least = 0.0, .at_most = 1e5});
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
    VisitClass(a, object_class);
    a.Field("length_m", length_m, {.at_least = 0.0, .at_most = 30.0});
    a.Field("width_m", width_m, {.at_least = 0.0, .at_most = 4.0});
    a.Field("height_m", height_m, {.at_least = 0.0, .at_most = 5.0});
    a.Field("v2v", v2v);
    a.Field("drive", drive);
    a.Field("sender", sender);
  }

  template <class Archive>
  static void VisitClass(Archive& a, ObjectClass& value) {
    a.Choice("class", value,
             {{"car", ObjectClass::kCar},
              {"van", ObjectClass::kVan},
              {"truck", ObjectClass::kTruck},
              {"bus", ObjectClass::kBus},
              {"motorcycle", ObjectClass::kMotorcycle},
              {"pedestrian", ObjectClass::kPedestrian},
              {"cyclist", ObjectClass::kCyclist}});
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
    VehicleSpec::VisitClass(a, object_class);
    a.Field("x_m", x_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("y_m", y_m, {.at_least = -1e5, .at_most = 1e5});
    a.Degrees("yaw_deg", yaw_rad, {.at_least = -360.0, .at_most = 360.0});
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

enum class SensorMode {
  kRealistic,    ///< Extended targets, static returns, clutter, ghosts, box errors.
  kIdealPoints,  ///< One detection at each visible vehicle's centre; nothing else.
};

struct SensorsSpec {
  SensorMode mode = SensorMode::kRealistic;
  double noise_scale = 1.0;       ///< Of every radar and camera sigma.
  double clutter_scale = 1.0;     ///< Of the sensors' own clutter rates.
  double ghost_scale = 1.0;       ///< Of mirror and double-bounce ghosts; 0 = none.
  double radar_latency_s = 0.02;  ///< Shortest; stamp to arrival.
  double radar_latency_spread_s = 0.02;
  double camera_latency_s = 0.06;
  double camera_latency_spread_s = 0.06;

  template <class Archive>
  void Visit(Archive& a) {
    a.Choice("mode", mode,
             {{"realistic", SensorMode::kRealistic}, {"ideal_points", SensorMode::kIdealPoints}});
    a.Field("noise_scale", noise_scale, {.at_least = 0.0, .at_most = 20.0});
    a.Field("clutter_scale", clutter_scale, {.at_least = 0.0, .at_most = 100.0});
    a.Field("ghost_scale", ghost_scale, {.at_least = 0.0, .at_most = 10.0});
    a.Field("radar_latency_s", radar_latency_s, {.at_least = 0.0, .at_most = 1.0});
    a.Field("radar_latency_spread_s", radar_latency_spread_s, {.at_least = 0.0, .at_most = 1.0});
    a.Field("camera_latency_s", camera_latency_s, {.at_least = 0.0, .at_most = 1.0});
    a.Field("camera_latency_spread_s", camera_latency_spread_s, {.at_least = 0.0, .at_most = 1.0});
  }
};

/// Error of a GNSS receiver: constant bias (drawn once per receiver), first-order Gauss-Markov and
/// white parts. Defaults: automotive receiver under open sky, measured on a real drive (u-blox,
/// 10 Hz: bias 0.54 m, the rest 0.1-0.2 m per axis) and published figures.
struct GnssErrorSpec {
  double bias_sigma_m = 0.7;     ///< Per axis.
  double markov_sigma_m = 0.25;  ///< Per axis.
  double markov_time_s = 30.0;
  double white_sigma_m = 0.05;
  double height_sigma_m = 1.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("bias_sigma_m", bias_sigma_m, {.at_least = 0.0, .at_most = 100.0});
    a.Field("markov_sigma_m", markov_sigma_m, {.at_least = 0.0, .at_most = 100.0});
    a.Field("markov_time_s", markov_time_s, {.above = 0.1, .at_most = 1e4});
    a.Field("white_sigma_m", white_sigma_m, {.at_least = 0.0, .at_most = 100.0});
    a.Field("height_sigma_m", height_sigma_m, {.at_least = 0.0, .at_most = 100.0});
  }
};

/// What every sender does unless its own `sender` block says otherwise.
struct BsmSpec {
  double rate_hz = 10.0;
  double period_jitter_s = 0.005;  ///< Uniform, either way.
  GnssErrorSpec gnss;
  double latency_s = 0.07;         ///< Shortest time from position fix to reception.
  double latency_spread_s = 0.13;  ///< Uniform on top.
  double speed_markov_mps = 0.05;  ///< Gauss-Markov speed error, time constant of `gnss`.
  double speed_white_mps = 0.05;
  double heading_markov_rad = FromDegrees(0.4);
  double heading_white_rad = FromDegrees(0.2);
  double semi_major_m = 0.0;  ///< Reported accuracy; 0 = what the error model gives.
  bool own_echo = false;      ///< The ego's own messages come back, too.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("rate_hz", rate_hz, {.above = 0.1, .at_most = 50.0});
    a.Field("period_jitter_s", period_jitter_s, {.at_least = 0.0, .at_most = 0.02});
    a.Field("gnss", gnss);
    a.Field("latency_s", latency_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("latency_spread_s", latency_spread_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("speed_markov_mps", speed_markov_mps, {.at_least = 0.0, .at_most = 20.0});
    a.Field("speed_white_mps", speed_white_mps, {.at_least = 0.0, .at_most = 20.0});
    a.Degrees("heading_markov_deg", heading_markov_rad, {.at_least = 0.0, .at_most = 180.0});
    a.Degrees("heading_white_deg", heading_white_rad, {.at_least = 0.0, .at_most = 180.0});
    a.Field("semi_major_m", semi_major_m, {.at_least = 0.0, .at_most = 12.65});
    a.Field("own_echo", own_echo);
  }
};

/// Who hears whom. Loss rises with distance as a logistic curve; an obstructed path counts as
/// longer.
struct RadioSpec {
  double base_loss = 0.02;
  double half_range_m = 350.0;  ///< Where half of the messages are lost.
  double range_slope_m = 50.0;
  double building_factor = 2.0;  ///< Length factor of a path through buildings.
  double vehicle_factor = 1.3;   ///< ... past a truck or bus.
  double tx_power_dbm = 20.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("base_loss", base_loss, {.at_least = 0.0, .at_most = 1.0});
    a.Field("half_range_m", half_range_m, {.above = 0.0, .at_most = 1e4});
    a.Field("range_slope_m", range_slope_m, {.above = 0.0, .at_most = 1e4});
    a.Field("building_factor", building_factor, {.at_least = 1.0, .at_most = 100.0});
    a.Field("vehicle_factor", vehicle_factor, {.at_least = 1.0, .at_most = 100.0});
    a.Field("tx_power_dbm", tx_power_dbm, {.at_least = -50.0, .at_most = 40.0});
  }
};

/// The ego's own receiver.
struct EgoGnssSpec {
  double rate_hz = 10.0;
  GnssErrorSpec error;
  double latency_s = 0.05;  ///< Stamp to arrival.
  double velocity_sigma_mps = 0.05;
  bool has_heading = true;  ///< Dual antenna or the receiver's own fusion.
  double heading_bias_rad = FromDegrees(0.1);
  double heading_sigma_rad = FromDegrees(0.2);
  double jump_at_s = 0.0;  ///< From then on the fix is off by jump_east/north; 0 = never.
  double jump_east_m = 0.0;
  double jump_north_m = 0.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("rate_hz", rate_hz, {.at_least = 0.5, .at_most = 50.0});
    a.Field("error", error);
    a.Field("latency_s", latency_s, {.at_least = 0.0, .at_most = 2.0});
    a.Field("velocity_sigma_mps", velocity_sigma_mps, {.at_least = 0.0, .at_most = 10.0});
    a.Field("has_heading", has_heading);
    a.Degrees("heading_bias_deg", heading_bias_rad, {.at_least = -180.0, .at_most = 180.0});
    a.Degrees("heading_sigma_deg", heading_sigma_rad, {.at_least = 0.0, .at_most = 180.0});
    a.Field("jump_at_s", jump_at_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("jump_east_m", jump_east_m, {.at_least = -1e6, .at_most = 1e6});
    a.Field("jump_north_m", jump_north_m, {.at_least = -1e6, .at_most = 1e6});
  }
};

/// The ego's wheel speed and gyro. Scale: a production car measured -0.8 % against its GNSS/INS.
struct OdometrySpec {
  double rate_hz = 50.0;
  double speed_scale = 1.004;  ///< Measured speed = this times the true one, plus noise.
  double speed_sigma_mps = 0.03;
  double yaw_rate_bias_radps = FromDegrees(0.03);
  double yaw_rate_sigma_radps = FromDegrees(0.06);
  double accel_sigma_mps2 = 0.1;
  double latency_s = 0.003;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("rate_hz", rate_hz, {.at_least = 5.0, .at_most = 200.0});
    a.Field("speed_scale", speed_scale, {.at_least = 0.8, .at_most = 1.2});
    a.Field("speed_sigma_mps", speed_sigma_mps, {.at_least = 0.0, .at_most = 5.0});
    a.Degrees("yaw_rate_bias_degps", yaw_rate_bias_radps, {.at_least = -10.0, .at_most = 10.0});
    a.Degrees("yaw_rate_sigma_degps", yaw_rate_sigma_radps, {.at_least = 0.0, .at_most = 10.0});
    a.Field("accel_sigma_mps2", accel_sigma_mps2, {.at_least = 0.0, .at_most = 10.0});
    a.Field("latency_s", latency_s, {.at_least = 0.0, .at_most = 1.0});
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
  /// CSV of recorded or imported motion, beside this file. Columns time_s, id, class, x_m, y_m,
  /// yaw_rad, speed_mps, length_m, width_m; world frame, centre of the footprint.
  std::string trajectories;
  double v2v_share = 0.0;  ///< Of the vehicles in `trajectories`, drawn per id.
  std::vector<ParkedSpec> parked;
  std::vector<BuildingSpec> buildings;
  std::vector<PoleSpec> poles;
  std::vector<PoleRowSpec> pole_rows;
  std::vector<RailSpec> rails;
  VehicleConfig vehicle;  ///< The ego car: body and sensors.
  SensorsSpec sensors;
  BsmSpec bsm;
  RadioSpec radio;
  EgoGnssSpec gnss;
  OdometrySpec odometry;

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
    a.Text("trajectories", trajectories);
    a.Field("v2v_share", v2v_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("parked", parked);
    a.Field("buildings", buildings);
    a.Field("poles", poles);
    a.Field("pole_rows", pole_rows);
    a.Field("rails", rails);
    a.Field("vehicle", vehicle);
    a.Field("sensors", sensors);
    a.Field("bsm", bsm);
    a.Field("radio", radio);
    a.Field("gnss", gnss);
    a.Field("odometry", odometry);
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

/// The effective scenario, every default spelled out, as YAML that LoadScenario takes again.
std::string ToYaml(const Scenario& scenario);

}  // namespace v2vouch::sim
