// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/alignment/alignment.h"
#include "daemon/base/visit.h"
#include "daemon/data/vehicle.h"
#include "daemon/odometry/ego_reading_config.h"
#include "daemon/pipeline/timeline_config.h"
#include "daemon/preprocessing/radar/radar_preprocessing.h"
#include "daemon/tracking/tracker.h"
#include "daemon/v2v/intake.h"
#include "daemon/v2v_perception/priority_config.h"
#include "daemon/visibility/visibility.h"

namespace v2vouch {

/// Everything perception can be told, each room's settings under its own key.
struct PerceptionConfig {
  VehicleConfig vehicle;
  TimelineConfig timeline;
  EgoReadingConfig ego_motion;
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
    a.Field("ego_motion", ego_motion);
    a.Field("radar", radar);
    a.Field("visibility", visibility);
    a.Field("tracking", tracking);
    a.Field("alignment", alignment);
    a.Field("v2v", v2v);
    a.Field("priority", priority);
  }
};

}  // namespace v2vouch
