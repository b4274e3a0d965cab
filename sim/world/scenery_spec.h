// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"

/// What stands beside the road. Parts of a Scenario.
namespace v2vouch::sim {

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

}  // namespace v2vouch::sim
