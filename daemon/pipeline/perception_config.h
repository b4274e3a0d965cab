// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/visit.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/local/perception/local_config.h"
#include "daemon/pipeline/timeline_config.h"
#include "daemon/v2v/alignment/alignment.h"
#include "daemon/v2v/intake/intake.h"
#include "daemon/v2v/perception/priority_config.h"

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

  /// What LOCAL's wing is told of it.
  [[nodiscard]] LocalConfig local() const {
    return {vehicle, ego_motion, radar, visibility, tracking};
  }

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
