// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/common/base/visit.h"

/// Routes, and how a vehicle drives along them. Parts of a Scenario.
namespace v2vouch::sim {

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

}  // namespace v2vouch::sim
