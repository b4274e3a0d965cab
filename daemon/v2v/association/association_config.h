// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/visit.h"

namespace v2vouch {

/// Settings of the paper's plain method (`association: paper`).
struct PaperConfig {
  double epsilon = 3.0;           ///< Threshold of the Mahalanobis distance.
  double position_sigma_m = 2.0;  ///< C = position_sigma_m^2 I.
  double keep_alive_s = 2.0;      ///< A pair without its LOCAL track lives on the sender's BSMs ...
                                  ///< ... until none has come for this long.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("epsilon", epsilon, {.above = 0.0, .at_most = 100.0});
    a.Field("position_sigma_m", position_sigma_m, {.above = 0.0, .at_most = 100.0});
    a.Field("keep_alive_s", keep_alive_s, {.above = 0.0, .at_most = 60.0});
  }
};

/// Settings of the safe association (`association: safe`).
struct AssociationConfig {
  double bias_sigma_m = 1.5;        ///< Prior of a sender's GNSS bias, per axis.
  double bias_decay_s = 90.0;       ///< Gauss-Markov time constant of that bias.
  double new_pair_gate = 13.8;      ///< Chi-square of position (2 dof, 0.999) that starts a pair.
  double background_per_m2 = 0.01;  ///< Density of vehicles that the claim could be instead.
  double speed_background_mps = 20.0;  ///< Spread of their speeds; headings are uniform.
  double forgetting_s = 10.0;          ///< Evidence fades with this time constant.
  double max_level = 3.0;      ///< Of the learnt bias (2 dof, 0.95): beyond, nothing is validated.
  double max_speed_mps = 0.5;  ///< Mean difference in speed beyond which nothing is validated.
  double min_margin = 3.0;     ///< Log-likelihood by which the second best must be beaten.
  double incumbent_bonus = 9.2;          ///< Head start of a validated pair in the assignment.
  double max_height_difference_m = 4.0;  ///< Farther apart in known elevation: never a pair.
  double pair_timeout_s = 2.0;           ///< A pair not observed for this long is forgotten.
  int max_pairs = 128;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("bias_sigma_m", bias_sigma_m, {.above = 0.0, .at_most = 5.0});
    a.Field("bias_decay_s", bias_decay_s, {.above = 1.0, .at_most = 1000.0});
    a.Field("new_pair_gate", new_pair_gate, {.above = 1.0, .at_most = 100.0});
    a.Field("background_per_m2", background_per_m2, {.above = 0.0, .at_most = 1.0});
    a.Field("speed_background_mps", speed_background_mps, {.above = 0.1, .at_most = 100.0});
    a.Field("forgetting_s", forgetting_s, {.above = 0.5, .at_most = 600.0});
    a.Field("max_level", max_level, {.above = 0.1, .at_most = 50.0});
    a.Field("max_speed_mps", max_speed_mps, {.at_least = 0.0, .at_most = 20.0});
    a.Field("min_margin", min_margin, {.at_least = 0.0, .at_most = 100.0});
    a.Field("incumbent_bonus", incumbent_bonus, {.at_least = 0.0, .at_most = 100.0});
    a.Field("max_height_difference_m", max_height_difference_m, {.above = 0.0, .at_most = 100.0});
    a.Field("pair_timeout_s", pair_timeout_s, {.above = 0.1, .at_most = 60.0});
    a.Field("max_pairs", max_pairs, {.at_least = 8, .at_most = 4096});
  }
};

}  // namespace v2vouch
