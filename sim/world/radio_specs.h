// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"

/// Sections of a scenario file about those who talk: GNSS receivers, on-board units, the radio.
/// World frame W as in scenario.h.
namespace v2vouch::sim {

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

/// Spells of a large position error, as street canyons give: each rises and falls within `rise_s`,
/// in a direction and to a size of its own.
struct ErrorBurstSpec {
  double every_s = 0.0;  ///< Mean time from one to the next, drawn per sender; 0 = none.
  double lasts_s = 5.0;
  double low_m = 3.0;
  double high_m = 8.0;
  double rise_s = 0.5;
  bool is_reported = true;  ///< The reported accuracy follows.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("every_s", every_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("lasts_s", lasts_s, {.above = 0.0, .at_most = 1e5});
    a.Field("low_m", low_m, {.at_least = 0.0, .at_most = 1e3});
    a.Field("high_m", high_m, {.at_least = 0.0, .at_most = 1e3});
    a.Field("rise_s", rise_s, {.at_least = 0.0, .at_most = 1e3});
    a.Field("is_reported", is_reported);
  }
};

/// What every sender does unless its own `sender` block says otherwise.
struct BsmSpec {
  double rate_hz = 10.0;
  double period_jitter_s = 0.005;  ///< Uniform, either way.
  GnssErrorSpec gnss;
  double latency_s = 0.07;         ///< Shortest time from position fix to reception.
  double latency_spread_s = 0.13;  ///< Uniform on top.
  double position_age_s = 0.0;     ///< Every place told is so much older than its time stamp says.
  double speed_markov_mps = 0.05;  ///< Gauss-Markov speed error, time constant of `gnss`.
  double speed_white_mps = 0.05;
  double heading_markov_rad = FromDegrees(0.4);
  double heading_white_rad = FromDegrees(0.2);
  double semi_major_m = 0.0;  ///< Reported accuracy; 0 = what the error model gives.
  ErrorBurstSpec bursts;
  double pair_share = 0.0;                ///< Of the messages: followed by one more 50 ms later.
  double identity_change_s = 0.0;         ///< All take a new identity once, this late ...
  double identity_change_spread_s = 0.0;  ///< ... or up to so much later; 0, 0 = never.
  double long_reference_m =
      0.0;  ///< Vehicles above 10 m tell of a point so far before their centre.
  double leap_second_at_s =
      0.0;                ///< For one second from then on secMark is 60000 and more; 0 = never.
  bool sparse = false;    ///< All that J2735 lets be unavailable is.
  bool own_echo = false;  ///< The ego's own messages come back, too.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("rate_hz", rate_hz, {.above = 0.1, .at_most = 50.0});
    a.Field("period_jitter_s", period_jitter_s, {.at_least = 0.0, .at_most = 0.02});
    a.Field("gnss", gnss);
    a.Field("latency_s", latency_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("latency_spread_s", latency_spread_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("position_age_s", position_age_s, {.at_least = 0.0, .at_most = 2.0});
    a.Field("speed_markov_mps", speed_markov_mps, {.at_least = 0.0, .at_most = 20.0});
    a.Field("speed_white_mps", speed_white_mps, {.at_least = 0.0, .at_most = 20.0});
    a.Degrees("heading_markov_deg", heading_markov_rad, {.at_least = 0.0, .at_most = 180.0});
    a.Degrees("heading_white_deg", heading_white_rad, {.at_least = 0.0, .at_most = 180.0});
    a.Field("semi_major_m", semi_major_m, {.at_least = 0.0, .at_most = 12.65});
    a.Field("bursts", bursts);
    a.Field("pair_share", pair_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("identity_change_s", identity_change_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("identity_change_spread_s", identity_change_spread_s,
            {.at_least = 0.0, .at_most = 1e5});
    a.Field("long_reference_m", long_reference_m, {.at_least = -15.0, .at_most = 15.0});
    a.Field("leap_second_at_s", leap_second_at_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("sparse", sparse);
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
  double gap_every_s = 0.0;  ///< Mean time between two silences of a sender; 0 = none.
  double gap_max_s = 7.0;    ///< Longest silence; most are short: this times u^4, u uniform.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("base_loss", base_loss, {.at_least = 0.0, .at_most = 1.0});
    a.Field("half_range_m", half_range_m, {.above = 0.0, .at_most = 1e4});
    a.Field("range_slope_m", range_slope_m, {.above = 0.0, .at_most = 1e4});
    a.Field("building_factor", building_factor, {.at_least = 1.0, .at_most = 100.0});
    a.Field("vehicle_factor", vehicle_factor, {.at_least = 1.0, .at_most = 100.0});
    a.Field("tx_power_dbm", tx_power_dbm, {.at_least = -50.0, .at_most = 40.0});
    a.Field("gap_every_s", gap_every_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("gap_max_s", gap_max_s, {.above = 0.0, .at_most = 1e3});
  }
};

/// What sets one sender apart from the scenario's `bsm` section.
struct SenderSpec {
  double rate_hz = 0.0;      ///< 0 = as in `bsm`.
  double bias_east_m = 0.0;  ///< Added to the bias drawn.
  double bias_north_m = 0.0;
  double noise_scale = 1.0;  ///< Of all this sender's GNSS errors.
  double latency_scale = 1.0;
  double position_age_s = 0.0;     ///< Added to that of `bsm`.
  double semi_major_m = 0.0;       ///< Reported accuracy; 0 = as in `bsm`.
  double identity_change_s = 0.0;  ///< Takes a new TemporaryID and certificate then; 0 = never.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("rate_hz", rate_hz, {.at_least = 0.0, .at_most = 50.0});
    a.Field("bias_east_m", bias_east_m, {.at_least = -1e3, .at_most = 1e3});
    a.Field("bias_north_m", bias_north_m, {.at_least = -1e3, .at_most = 1e3});
    a.Field("noise_scale", noise_scale, {.at_least = 0.0, .at_most = 100.0});
    a.Field("latency_scale", latency_scale, {.at_least = 0.0, .at_most = 20.0});
    a.Field("position_age_s", position_age_s, {.at_least = 0.0, .at_most = 2.0});
    a.Field("semi_major_m", semi_major_m, {.at_least = 0.0, .at_most = 12.7});
    a.Field("identity_change_s", identity_change_s, {.at_least = 0.0, .at_most = 1e5});
  }
};

}  // namespace v2vouch::sim
