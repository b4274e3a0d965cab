// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/alignment/alignment.h"
#include "daemon/base/visit.h"
#include "daemon/data/vehicle.h"
#include "daemon/pipeline/priority_config.h"
#include "daemon/preprocessing/radar/radar_preprocessing.h"
#include "daemon/tracking/tracker.h"
#include "daemon/v2v/intake.h"
#include "daemon/visibility/visibility.h"

namespace v2vouch {

/// Time rules (DESIGN section 4).
struct TimelineConfig {
  double replay_buffer_s = 0.7;  ///< How late a message may be and still be put in its place.
  double future_s = 1.0;         ///< A stamp this far ahead of the other own sensors is refused.
  double reset_s = 3.0;          ///< All own sensors stepping back by more than this: start again.
  double stale_after_s = 0.1;    ///< No frame for so long: a predicted copy is published.
  double interest_m = 250.0;     ///< Claims farther away can meet no track: listed, not followed.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("replay_buffer_s", replay_buffer_s, {.at_least = 0.1, .at_most = 2.0});
    a.Field("future_s", future_s, {.above = 0.1, .at_most = 60.0});
    a.Field("reset_s", reset_s, {.above = 0.5, .at_most = 3600.0});
    a.Field("stale_after_s", stale_after_s, {.above = 0.01, .at_most = 5.0});
    a.Field("interest_m", interest_m, {.at_least = 50.0, .at_most = 5000.0});
  }
};

/// Everything perception can be told, each room's settings under its own key.
struct PerceptionConfig {
  VehicleConfig vehicle;
  TimelineConfig timeline;
  RadarPreprocessingConfig radar;
  VisibilityConfig visibility;
  TrackerConfig tracking;
  AlignmentConfig alignment;
  IntakeConfig v2v;
  PriorityConfig priority;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("vehicle", vehicle);
    a.Field("timeline", timeline);
    a.Field("radar", radar);
    a.Field("visibility", visibility);
    a.Field("tracking", tracking);
    a.Field("alignment", alignment);
    a.Field("v2v", v2v);
    a.Field("priority", priority);
  }
};

}  // namespace v2vouch
