// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"

namespace v2vouch::sim {

/// The air between two cars. Ranges: published field trials of 5.9 GHz, rounded; not our own.
struct LinkSpec {
  double open_90_m = 300.0;       ///< Nine of ten messages arrive at this distance, line of sight.
  double blocked_90_m = 120.0;    ///< The same with a vehicle or building between.
  double steepness = 4.0;         ///< How fast the share falls with distance beyond.
  double delay_s = 0.001;         ///< Shortest.
  double delay_spread_s = 0.019;  ///< Uniform on top.
  double late_share = 0.0;        ///< Messages that come `late_s` later than others: overtaken.
  double late_s = 0.15;
  double duplicate_share = 0.0;  ///< A second copy, of another antenna: own delay and signal.
  double burst_every_s = 0.0;    ///< Mean time between spells of interference; 0 = none.
  double burst_s = 0.5;          ///< Mean length of a spell.
  double burst_loss = 0.9;       ///< Lost within one.
  double signal_10m_dbm = -55.0;
  double signal_exponent = 2.2;  ///< -10 n log10(d / 10 m).
  double shadowing_db = 3.0;     ///< Changes within about a second.
  double blocked_db = 10.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("open_90_m", open_90_m, {.above = 1.0, .at_most = 1e5});
    a.Field("blocked_90_m", blocked_90_m, {.above = 1.0, .at_most = 1e5});
    a.Field("steepness", steepness, {.above = 0.5, .at_most = 20.0});
    a.Field("delay_s", delay_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("delay_spread_s", delay_spread_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("late_share", late_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("late_s", late_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("duplicate_share", duplicate_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("burst_every_s", burst_every_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("burst_s", burst_s, {.above = 0.0, .at_most = 1e4});
    a.Field("burst_loss", burst_loss, {.at_least = 0.0, .at_most = 1.0});
    a.Field("signal_10m_dbm", signal_10m_dbm, {.at_least = -120.0, .at_most = 0.0});
    a.Field("signal_exponent", signal_exponent, {.at_least = 1.0, .at_most = 6.0});
    a.Field("shadowing_db", shadowing_db, {.at_least = 0.0, .at_most = 20.0});
    a.Field("blocked_db", blocked_db, {.at_least = 0.0, .at_most = 60.0});
  }
};

/// One car's on-board unit, seen from its computer.
struct RadioCarSpec {
  int id = 0;             ///< Of the vehicle in TRUTH; 0 = the ego car.
  int listen = 0;         ///< UDP port on loopback: what comes here is sent by this car; 0 = mute.
  std::string deliver{};  ///< ADDRESS:PORT to which it hands what it hears; "" = deaf.
  bool radiotap = false;  ///< Hands over whole radio packets, with the signal's strength.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("id", id, {.at_least = 0, .at_most = 1000000});
    a.Field("listen", listen, {.at_least = 0, .at_most = 65535});
    a.Text("deliver", deliver);
    a.Field("radiotap", radiotap);
  }
};

/// A building or wall, beside the vehicles of TRUTH. World frame W.
struct RadioObstacleSpec {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double length_m = 20.0;
  double width_m = 20.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("x_m", x_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("y_m", y_m, {.at_least = -1e5, .at_most = 1e5});
    a.Degrees("yaw_deg", yaw_rad, {.at_least = -360.0, .at_most = 360.0});
    a.Field("length_m", length_m, {.above = 0.0, .at_most = 1e4});
    a.Field("width_m", width_m, {.above = 0.0, .at_most = 1e4});
  }
};

struct RadioConfig {
  std::vector<RadioCarSpec> cars;
  std::vector<RadioObstacleSpec> obstacles;
  LinkSpec link;
  double tall_m = 1.9;  ///< Vehicles as high as this stand between antennas on roofs.
  std::string lcm_url;  ///< TRUTH comes from here; "" = LCM_DEFAULT_URL.
  std::string truth_channel = "TRUTH";

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("cars", cars);
    a.Field("obstacles", obstacles);
    a.Field("link", link);
    a.Field("tall_m", tall_m, {.at_least = 0.0, .at_most = 10.0});
    a.Text("lcm_url", lcm_url);
    a.Text("truth_channel", truth_channel);
  }
};

}  // namespace v2vouch::sim
