// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/visit.h"

namespace v2vouch::warnings {

/// When which level begins. Times are times to conflict: a vehicle that brakes with `decel` from
/// speed v for a conflict at constant speed has to begin v / (2 decel) before it.
struct WarningsConfig {
  double horizon_s = 6.0;           ///< How far ahead motion is predicted.
  double advise_probability = 0.2;  ///< ADVISE from this probability of contact on.
  double warn_probability = 0.5;
  double urgent_probability = 0.9;
  /// URGENT of crossing vehicles: two degrees of heading decide there whether the bodies touch, and
  /// the last moment to brake does not wait for them.
  double urgent_crossing_probability = 0.75;
  double driver_reaction_s = 1.2;  ///< WARN: reaction and braking of a driver ...
  double driver_decel_mps2 = 4.0;  ///< ... and this much before he would have to.
  /// Of crossing and oncoming vehicles. Of those ahead only as far as a driver who brakes with
  /// `usual_decel_mps2`, without any reaction, would have begun: usual stops are not warned of.
  double warn_margin_s = 0.5;
  double usual_decel_mps2 = 2.2;
  double planner_reaction_s = 0.2;  ///< URGENT: the same of a planner.
  double planner_decel_mps2 = 8.0;
  double urgent_margin_s = 0.3;
  double body_margin_m = 0.2;        ///< Added round the ego in the box test below URGENT.
  double path_margin_m = 0.3;        ///< "In path": this much beyond both half widths.
  double hidden_sigmas = 2.0;        ///< Reachable set of hidden vehicles: draws within this.
  double urgent_unseen_s = 2.0;      ///< No URGENT for vehicles unseen by own sensors for longer.
  double gap_advise_s = 2.0;         ///< LTA: gap between the two bodies at one place, ADVISE ...
  double gap_warn_s = 1.0;           ///< ... and WARN.
  double start_accel_mps2 = 1.75;    ///< Of an ego that starts from a stop.
  double hard_braking_mps2 = 3.9;    ///< EEBL: 0.4 g, as SAE J2735 defines the event.
  double braking_probability = 0.8;  ///< EEBL: that it brakes harder than that ...
  /// EEBL: a vouched sender's claim of hard braking counts where own sensors see it brake harder
  /// than this with the same probability.
  double claimed_braking_mps2 = 1.5;
  double braking_hold_s = 0.2;  ///< ... for so long.
  double braking_range_m = 300.0;
  double beside_m = 3.0;   ///< BSW: the zone beside the car (ISO 17387) ...
  double behind_m = 3.0;   ///< ... ends this far behind its rear.
  double closing_s = 3.0;  ///< LCW: time in which a vehicle behind closes up.
  double begin_s = 0.1;  ///< A level begins when its condition holds in two lists or for this long.
  /// A vehicle listed for `sudden_s` that has become faster by more than 1.5 m/s and this
  /// acceleration allow within that time is only advised of.
  double sudden_accel_mps2 = 6.0;
  double sudden_s = 0.6;
  double clear_s = 0.3;     ///< It ends when the condition was false for this long ...
  double shortest_s = 1.0;  ///< ... and not before it was on for so long.
  double lost_s = 2.0;      ///< LOST stands for so long.
  double stale_s = 0.3;     ///< Lists and ego motion older than this are stale.
  double intent_s = 0.5;    ///< EGO_INTENT older than this counts as absent.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("horizon_s", horizon_s, {.at_least = 1.0, .at_most = 10.0});
    a.Field("advise_probability", advise_probability, {.above = 0.0, .at_most = 1.0});
    a.Field("warn_probability", warn_probability, {.above = 0.0, .at_most = 1.0});
    a.Field("urgent_probability", urgent_probability, {.above = 0.0, .at_most = 1.0});
    a.Field("urgent_crossing_probability", urgent_crossing_probability,
            {.above = 0.0, .at_most = 1.0});
    a.Field("driver_reaction_s", driver_reaction_s, {.at_least = 0.0, .at_most = 5.0});
    a.Field("driver_decel_mps2", driver_decel_mps2, {.above = 0.5, .at_most = 12.0});
    a.Field("warn_margin_s", warn_margin_s, {.at_least = 0.0, .at_most = 5.0});
    a.Field("usual_decel_mps2", usual_decel_mps2, {.above = 0.5, .at_most = 12.0});
    a.Field("planner_reaction_s", planner_reaction_s, {.at_least = 0.0, .at_most = 5.0});
    a.Field("planner_decel_mps2", planner_decel_mps2, {.above = 0.5, .at_most = 12.0});
    a.Field("urgent_margin_s", urgent_margin_s, {.at_least = 0.0, .at_most = 5.0});
    a.Field("body_margin_m", body_margin_m, {.at_least = 0.0, .at_most = 2.0});
    a.Field("path_margin_m", path_margin_m, {.at_least = 0.0, .at_most = 2.0});
    a.Field("hidden_sigmas", hidden_sigmas, {.at_least = 0.5, .at_most = 4.0});
    a.Field("urgent_unseen_s", urgent_unseen_s, {.at_least = 0.0, .at_most = 60.0});
    a.Field("gap_advise_s", gap_advise_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("gap_warn_s", gap_warn_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("start_accel_mps2", start_accel_mps2, {.above = 0.0, .at_most = 5.0});
    a.Field("hard_braking_mps2", hard_braking_mps2, {.above = 0.0, .at_most = 12.0});
    a.Field("braking_probability", braking_probability, {.above = 0.0, .at_most = 1.0});
    a.Field("claimed_braking_mps2", claimed_braking_mps2, {.at_least = 0.0, .at_most = 12.0});
    a.Field("braking_hold_s", braking_hold_s, {.at_least = 0.0, .at_most = 2.0});
    a.Field("braking_range_m", braking_range_m, {.above = 0.0, .at_most = 1000.0});
    a.Field("beside_m", beside_m, {.above = 0.0, .at_most = 6.0});
    a.Field("behind_m", behind_m, {.at_least = 0.0, .at_most = 30.0});
    a.Field("closing_s", closing_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("begin_s", begin_s, {.at_least = 0.0, .at_most = 2.0});
    a.Field("sudden_accel_mps2", sudden_accel_mps2, {.above = 0.0, .at_most = 100.0});
    a.Field("sudden_s", sudden_s, {.above = 0.0, .at_most = 3.0});
    a.Field("clear_s", clear_s, {.at_least = 0.0, .at_most = 5.0});
    a.Field("shortest_s", shortest_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("lost_s", lost_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("stale_s", stale_s, {.above = 0.0, .at_most = 5.0});
    a.Field("intent_s", intent_s, {.above = 0.0, .at_most = 5.0});
  }
};

/// The ego's body as warnings need it (VehicleConfig::length_m, width_m, centre_x_m).
struct EgoBody {
  double length_m = 4.7;
  double width_m = 1.85;
  double centre_x_m = 1.4;
};

}  // namespace v2vouch::warnings
