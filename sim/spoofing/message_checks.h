// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {

/// Thresholds of the published message-only detectors: the legacy checks of F2MD (Kamel et al.,
/// 2020, repository josephkamel/veins-f2md), which CaTCH and the baseline of VeReMi NextGen (2026)
/// use too. Facts taken from there; the code is our own.
struct MessageCheckSettings {
  double range_m = 420.0;       ///< Claims further from the receiver are not believed.
  double appearance_s = 2.1;    ///< A sender silent for so long, or new, appears ...
  double appearance_m = 420.0;  ///< ... suspiciously when within this.
  double speed_mps = 40.0;
  double accel_mps2 = 3.0;
  double decel_mps2 = 4.5;
  double window_s = 3.1;     ///< Two messages are compared within this.
  double margin_up_m = 2.1;  ///< Moved further than both speeds allow.
  /// Moved less far than both speeds allow: a + b v + c v^2 [m], v in m/s; not below `margin_up_m`
  /// (ours: the parabola falls to 0 at 32 m/s, where it would flag every honest car).
  double margin_down_a = 6.2, margin_down_b = 0.357, margin_down_c = -0.0169;
  double heading_rad = 1.5707963267948966;  ///< Direction of travel against heading ...
  double heading_window_s = 1.1;            ///< ... over at most this ...
  double heading_from_m = 1.0;              ///< ... where it moved this far.
  /// Of the nominal interval: 0.9 s of 1 s there.
  double beacon_share = 0.9;
  double beacon_s = 0.1;  ///< Nominal interval here (SAE J2945/1: 10 Hz).
  /// Ours: a message that another has overtaken by up to this is compared with nothing.
  double disorder_s = 1.0;
  double kalman_m = 4.0;  ///< Innovations of a constant-velocity filter.
  double kalman_mps = 1.0;
  double overlap_share = 0.5;  ///< With another sender's newest claim, fading to 0 ...
  double overlap_s = 2.0;      ///< ... at this age.
  // Behavioural timer: grows by gain exp(steepness (1 - worst factor)) per message, falls by 1.
  double timer_gain = 0.0005;
  double timer_steepness = 10.0;
  double timer_alarm = 5.5066;
};

/// Which messages a receiver with nothing but its radio and its own place would flag: every check
/// gives 0 or 1, the worst feeds the sender's timer, the message is flagged while the timer is
/// above its alarm (one failed check flags about six messages). What a message says is taken from
/// TRUTH_BSM's claimed values, its time from reception and age. The checks against a road map and
/// against simulator truth are left out: this receiver has neither.
/// @return one answer per message of `log.bsm_truths`.
std::vector<bool> CheckMessages(const RunLog& log, const MessageCheckSettings& settings = {});

}  // namespace v2vouch::evaluation
