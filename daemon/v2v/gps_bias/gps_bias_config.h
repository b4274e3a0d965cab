// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/visit.h"

namespace v2vouch {

/// GPS bias of senders, per sender and common to all.
struct GpsBiasConfig {
  bool enabled = true;  ///< false: every sender keeps the prior.
  /// An estimate is used by messages at least so much younger than its data: more than the replay
  /// buffer and what a message may be ahead of the sensors, so that all orders of arrival agree.
  double estimate_age_s = 2.0;
  double window_s = 60.0;        ///< Residuals older than this are forgotten.
  double knot_s = 10.0;          ///< Of the wandering part, which is linear between knots.
  int min_residuals = 10;        ///< Of a sender in the window; below, nothing is said of it.
  int max_senders = 32;          ///< The table's size; the sender silent for longest is evicted.
  double common_sigma_m = 1.5;   ///< What all are off by: the ego's own error, per axis.
  double sender_sigma_m = 1.5;   ///< A sender's own constant part, per axis.
  double wander_sigma_m = 0.5;   ///< A sender's wandering part: first-order Gauss-Markov ...
  double wander_decay_s = 45.0;  ///< ... with this time constant.
  double white_hz = 2.0;         ///< So many residuals a second count as independent.
  double huber = 2.0;            ///< Whitened residuals beyond this pull with constant force.
  double max_bias_m = 5.0;       ///< Beyond it is no bias: quarantine.
  double max_change_m = 3.0;     ///< Of the wandering part within a window; honest ones stay below.
  double null_chi_square = 3.5;  ///< Wandering, per degree of freedom; beyond it is no noise.
  int min_common_senders = 3;    ///< Fewer say nothing of what is common.
  double leave_one_out_gate = 13.8;  ///< Chi-square, 2 dof: one sender alone moves the common part.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("enabled", enabled);
    a.Field("estimate_age_s", estimate_age_s, {.at_least = 0.5, .at_most = 10.0});
    a.Field("window_s", window_s, {.at_least = 5.0, .at_most = 300.0});
    a.Field("knot_s", knot_s, {.at_least = 1.0, .at_most = 60.0});
    a.Field("min_residuals", min_residuals, {.at_least = 2, .at_most = 1000});
    a.Field("max_senders", max_senders, {.at_least = 1, .at_most = 256});
    a.Field("common_sigma_m", common_sigma_m, {.above = 0.0, .at_most = 20.0});
    a.Field("sender_sigma_m", sender_sigma_m, {.above = 0.0, .at_most = 20.0});
    a.Field("wander_sigma_m", wander_sigma_m, {.above = 0.0, .at_most = 5.0});
    a.Field("wander_decay_s", wander_decay_s, {.above = 1.0, .at_most = 1000.0});
    a.Field("white_hz", white_hz, {.above = 0.1, .at_most = 100.0});
    a.Field("huber", huber, {.above = 0.1, .at_most = 100.0});
    a.Field("max_bias_m", max_bias_m, {.above = 0.1, .at_most = 20.0});
    a.Field("max_change_m", max_change_m, {.above = 0.1, .at_most = 20.0});
    a.Field("null_chi_square", null_chi_square, {.above = 1.0, .at_most = 100.0});
    a.Field("min_common_senders", min_common_senders, {.at_least = 2, .at_most = 100});
    a.Field("leave_one_out_gate", leave_one_out_gate, {.above = 1.0, .at_most = 1000.0});
  }
};

}  // namespace v2vouch
