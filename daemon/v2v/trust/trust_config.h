// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"
#include "daemon/v2v/trust/claimed_place.h"
#include "daemon/v2v/trust/common_mode.h"
#include "daemon/v2v/trust/shared_place.h"
#include "daemon/v2v/trust/tombstone_config.h"

namespace v2vouch {

/// Thresholds of the trust checks and of the state machine. "Withdraw" stops
/// believing, "accuse" reports a liar.
struct TrustConfig {
  int candidate_messages = 3;     ///< Consistent messages that make a CANDIDATE.
  int co_observations = 10;       ///< Claims seen together with the sensors before VALIDATED ...
  double co_observed_s = 1.5;     ///< ... and over this long.
  int slow_observations = 4;      ///< So many suffice for a sender at 1 Hz ...
  double slow_observed_s = 2.8;   ///< ... over this long.
  int again_observations = 5;     ///< Relied on in the last again_s and not blamed: so many ...
  double again_observed_s = 0.6;  ///< ... over so long suffice.
  double again_s = 10.0;
  double mean_time_s = 1.0;       ///< Residuals are averaged over this time.
  double level_withdraw_m = 5.0;  ///< residual_level: level of the raw residual.
  double level_accuse_m = 12.0;
  double drift_withdraw_m = 3.0;  ///< residual_drift: its change over 10 s, or since validation.
  double drift_accuse_m = 10.0;
  /// residual_level, residual_drift: along-track limits grow by this times speed.
  double stale_position_s = 0.15;
  double speed_withdraw_mps = 1.0;  ///< velocity_residual: claimed against sensed velocity.
  double speed_accuse_mps = 2.0;
  double torn_m = 2.5;  ///< residual_jump: a change by so much at once is a break of either side.
  /// velocity_residual: only once the position has come so far from where it was.
  double leaving_m = 1.5;
  /// heading_residual, above heading_min_speed_mps.
  double heading_withdraw_rad = FromDegrees(15.0);
  double heading_accuse_rad = FromDegrees(30.0);
  double heading_min_speed_mps = 3.0;
  /// acceleration_residual: claimed against sensed acceleration, mean of 3 s.
  double accel_withdraw_mps2 = 3.0;
  /// plausible size: claimed size off by this share of the sensed one.
  double size_mismatch = 0.6;
  double odd_claim_m = 6.0;    ///< A claim so far from the others may be of another device ...
  int odd_claims = 5;          ///< ... but not so many in a row.
  double accuse_hold_s = 5.0;  ///< An accusing level must last this long.
  double suspect_s = 2.0;      ///< Least stay in SUSPECT.
  double clean_s = 15.0;       ///< Agreeing with the sensors before CANDIDATE; doubles each time.
  double max_clean_s = 60.0;
  double revoked_s = 60.0;  ///< Doubles each time.
  double max_revoked_s = 600.0;
  ClaimedPlaceConfig place;
  SharedPlaceConfig shared_place;
  CommonModeConfig common_mode;
  TombstoneConfig tombstone;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("candidate_messages", candidate_messages, {.at_least = 1, .at_most = 100});
    a.Field("co_observations", co_observations, {.at_least = 2, .at_most = 1000});
    a.Field("co_observed_s", co_observed_s, {.at_least = 0.2, .at_most = 60.0});
    a.Field("slow_observations", slow_observations, {.at_least = 2, .at_most = 1000});
    a.Field("slow_observed_s", slow_observed_s, {.at_least = 0.2, .at_most = 60.0});
    a.Field("again_observations", again_observations, {.at_least = 2, .at_most = 1000});
    a.Field("again_observed_s", again_observed_s, {.at_least = 0.2, .at_most = 60.0});
    a.Field("again_s", again_s, {.at_least = 0.0, .at_most = 600.0});
    a.Field("mean_time_s", mean_time_s, {.at_least = 0.1, .at_most = 10.0});
    a.Field("level_withdraw_m", level_withdraw_m, {.above = 0.0, .at_most = 50.0});
    a.Field("level_accuse_m", level_accuse_m, {.above = 0.0, .at_most = 50.0});
    a.Field("drift_withdraw_m", drift_withdraw_m, {.above = 0.0, .at_most = 50.0});
    a.Field("drift_accuse_m", drift_accuse_m, {.above = 0.0, .at_most = 50.0});
    a.Field("stale_position_s", stale_position_s, {.at_least = 0.0, .at_most = 1.0});
    a.Field("speed_withdraw_mps", speed_withdraw_mps, {.above = 0.0, .at_most = 20.0});
    a.Field("speed_accuse_mps", speed_accuse_mps, {.above = 0.0, .at_most = 20.0});
    a.Field("torn_m", torn_m, {.above = 0.0, .at_most = 50.0});
    a.Field("leaving_m", leaving_m, {.at_least = 0.0, .at_most = 20.0});
    a.Degrees("heading_withdraw_deg", heading_withdraw_rad, {.above = 0.0, .at_most = 180.0});
    a.Degrees("heading_accuse_deg", heading_accuse_rad, {.above = 0.0, .at_most = 180.0});
    a.Field("heading_min_speed_mps", heading_min_speed_mps, {.at_least = 0.5, .at_most = 20.0});
    a.Field("accel_withdraw_mps2", accel_withdraw_mps2, {.above = 0.0, .at_most = 50.0});
    a.Field("size_mismatch", size_mismatch, {.above = 0.0, .at_most = 10.0});
    a.Field("odd_claim_m", odd_claim_m, {.above = 0.0, .at_most = 100.0});
    a.Field("odd_claims", odd_claims, {.at_least = 1, .at_most = 100});
    a.Field("accuse_hold_s", accuse_hold_s, {.at_least = 0.0, .at_most = 60.0});
    a.Field("suspect_s", suspect_s, {.at_least = 0.0, .at_most = 60.0});
    a.Field("clean_s", clean_s, {.at_least = 0.0, .at_most = 600.0});
    a.Field("max_clean_s", max_clean_s, {.at_least = 0.0, .at_most = 3600.0});
    a.Field("revoked_s", revoked_s, {.at_least = 0.0, .at_most = 3600.0});
    a.Field("max_revoked_s", max_revoked_s, {.at_least = 0.0, .at_most = 36000.0});
    a.Field("place", place);
    a.Field("shared_place", shared_place);
    a.Field("common_mode", common_mode);
    a.Field("tombstone", tombstone);
  }
};

}  // namespace v2vouch
