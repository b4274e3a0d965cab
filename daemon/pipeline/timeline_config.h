// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/visit.h"

namespace v2vouch {

/// Time rules: how late a message may be, and what late messages may cost.
struct TimelineConfig {
  /// How late a message may be against the agreed time and still be put in its place; as far ahead
  /// of it a stamp may be.
  double replay_buffer_s = 0.7;
  double future_s = 1.0;       ///< A fix or BSM this far ahead of the own sensors is refused.
  double reset_s = 3.0;        ///< All own sensors stepping forward by more than this: start again.
  double stale_after_s = 0.1;  ///< No frame for so long: a predicted copy is published.
  double stale_hold_s = 1.0;   ///< No frame for so long: the lists are empty and blind.
  double interest_m = 250.0;   ///< Claims farther away can meet no track: listed, not followed.
  /// Frames that late data may cause to be run again, per second of message time. Beyond it late
  /// data are refused.
  double rerun_budget = 1500.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("replay_buffer_s", replay_buffer_s, {.at_least = 0.1, .at_most = 2.0});
    a.Field("future_s", future_s, {.above = 0.1, .at_most = 60.0});
    a.Field("reset_s", reset_s, {.above = 0.5, .at_most = 3600.0});
    a.Field("stale_after_s", stale_after_s, {.above = 0.01, .at_most = 5.0});
    a.Field("stale_hold_s", stale_hold_s, {.above = 0.01, .at_most = 10.0});
    a.Field("interest_m", interest_m, {.at_least = 50.0, .at_most = 5000.0});
    a.Field("rerun_budget", rerun_budget, {.at_least = 100.0, .at_most = 1e6});
  }
};

}  // namespace v2vouch
