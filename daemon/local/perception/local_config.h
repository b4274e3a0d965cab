// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/data/vehicle.h"
#include "daemon/local/odometry/ego_reading_config.h"
#include "daemon/local/radar/radar_preprocessing.h"
#include "daemon/local/tracking/tracker_config.h"
#include "daemon/local/visibility/visibility.h"

namespace v2vouch {

/// Everything LOCAL can be told, each room's settings by itself.
struct LocalConfig {
  VehicleConfig vehicle;
  EgoReadingConfig ego_motion;
  RadarPreprocessingConfig radar;
  VisibilityConfig visibility;
  TrackerConfig tracking;
};

}  // namespace v2vouch
