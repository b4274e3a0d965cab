// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/common/base/visit.h"

/// Section `traffic` of a scenario: vehicles nobody wrote down one by one.
namespace v2vouch::sim {

/// A lane that traffic drives in: a route, or a line beside it, at one speed.
struct TrafficLaneSpec {
  std::string route;
  double offset_m = 0.0;  ///< From the route, left positive.
  double speed_mps = 13.0;
  double from_m = 0.0;  ///< Starting places along the route at time 0, from here ...
  double to_m = 100.0;  ///< ... to here.
  double weight = 1.0;  ///< How many choose this lane, against the weights of the others.
  double truck_share = 0.1;
  double bus_share = 0.05;

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("route", route);
    a.Field("offset_m", offset_m, {.at_least = -50.0, .at_most = 50.0});
    a.Field("speed_mps", speed_mps, {.at_least = 0.0, .at_most = 70.0});
    a.Field("from_m", from_m, {.at_least = -1e4, .at_most = 1e5});
    a.Field("to_m", to_m, {.at_least = -1e4, .at_most = 1e5});
    a.Field("weight", weight, {.at_least = 0.0, .at_most = 1e3});
    a.Field("truck_share", truck_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("bus_share", bus_share, {.at_least = 0.0, .at_most = 1.0});
  }
};

/// `vehicles` more vehicles, drawn from the seed one after the other: lane, place, class, whether
/// it talks. One that would come closer than `gap_m` to anybody drawn or written before it, at any
/// time, is drawn again; so is one that would not be near the ego long enough, until there is no
/// more room there. A denser drawing of the same seed holds every vehicle of a thinner one. Ids
/// count up from kFirstTrafficId.
struct TrafficSpec {
  int vehicles = 0;
  double v2v_share = 0.5;
  double van_share = 0.1;          ///< Of those who are neither truck nor bus.
  double motorcycle_share = 0.05;  ///< The same.
  double bus_share = 0.0;          ///< Instead of the lanes' own; 0 = theirs.
  double truck_length_m = 0.0;     ///< 0 = the class's usual length.
  double bus_length_m = 0.0;
  double gap_m = 8.0;  ///< Free way before and behind.
  double near_m =
      90.0;  ///< Near: within this distance before the ego, 30 degrees to either side ...
  double near_s = 0.0;  ///< ... for at least so long in all.
  std::vector<TrafficLaneSpec> lanes;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("vehicles", vehicles, {.at_least = 0, .at_most = 1000});
    a.Field("v2v_share", v2v_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("van_share", van_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("motorcycle_share", motorcycle_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("bus_share", bus_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("truck_length_m", truck_length_m, {.at_least = 0.0, .at_most = 30.0});
    a.Field("bus_length_m", bus_length_m, {.at_least = 0.0, .at_most = 30.0});
    a.Field("gap_m", gap_m, {.at_least = 0.5, .at_most = 200.0});
    a.Field("near_m", near_m, {.above = 0.0, .at_most = 1e4});
    a.Field("near_s", near_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("lanes", lanes);
  }
};

inline constexpr unsigned kFirstTrafficId = 1001;

}  // namespace v2vouch::sim
