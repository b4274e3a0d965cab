// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/visit.h"
#include "daemon/common/models/ctra.h"

namespace v2vouch {

/// Settings of LOCAL fusion: births, confirmation, existence and what is published.
struct TrackerConfig {
  MotionNoise motion;
  bool point_targets = false;        ///< Detections are of the centre: no extent model.
  double gate_probability = 0.9999;  ///< Of the chi-square gate.
  double birth_per_m2_s = 2e-6;      ///< Density of new vehicles.
  double confirm_existence = 0.95;   ///< Published from here on ...
  double keep_existence = 0.5;       ///< ... until it falls below this.
  double delete_existence = 0.01;    ///< Once published, dropped below this.
  int confirm_hits = 3;           ///< Frames that measured it, all sensors, before it is published.
  double survival_per_s = 0.999;  ///< Probability to still be there after one second.
  double hidden_hold_s = 8.0;     ///< A hidden track is kept at most this long without a hit.
  double max_position_sigma_m = 5.0;  ///< A less certain track is not published anew.
  double list_cutoff_m = 4.0;   ///< c of the rule that lists a track and ends it, ListingRules.
  double miss_memory_s = 0.15;  ///< Misses of a published track closer than this are one.
  double camera_birth_range_m = 60.0;  ///< Farther out, boxes alone publish nothing.
  int max_tracks = 512;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("motion", motion);
    a.Field("point_targets", point_targets);
    a.Field("gate_probability", gate_probability, {.above = 0.5, .below = 1.0});
    a.Field("birth_per_m2_s", birth_per_m2_s, {.above = 0.0, .at_most = 1.0});
    a.Field("confirm_existence", confirm_existence, {.above = 0.0, .below = 1.0});
    a.Field("keep_existence", keep_existence, {.above = 0.0, .below = 1.0});
    a.Field("delete_existence", delete_existence, {.above = 0.0, .below = 1.0});
    a.Field("confirm_hits", confirm_hits, {.at_least = 1, .at_most = 100});
    a.Field("survival_per_s", survival_per_s, {.above = 0.0, .at_most = 1.0});
    a.Field("hidden_hold_s", hidden_hold_s, {.above = 0.0, .at_most = 30.0});
    a.Field("max_position_sigma_m", max_position_sigma_m, {.above = 0.1, .at_most = 100.0});
    a.Field("list_cutoff_m", list_cutoff_m, {.above = 0.1, .at_most = 100.0});
    a.Field("miss_memory_s", miss_memory_s, {.at_least = 0.0, .at_most = 5.0});
    a.Field("camera_birth_range_m", camera_birth_range_m, {.at_least = 0.0, .at_most = 200.0});
    a.Field("max_tracks", max_tracks, {.at_least = 1, .at_most = 4096});
  }
};

}  // namespace v2vouch
