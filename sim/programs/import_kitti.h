// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/import/kitti_events.h"

namespace v2vouch::sim {

/// What `v2vouch-import kitti` was asked for; empty: not given.
struct KittiRequest {
  std::string labels;
  std::string calibration;
  std::string oxts;
  std::string images;
  std::string out;
  double ego_speed_mps = 0.0;  ///< Where neither labels nor oxts tell it.
  bool ego_stands = false;     ///< Do not look for the ego's motion in the labels.
  bool as_json = false;
  KittiOptions options;
};

/// @return the program's exit code; what went wrong is told on standard error.
int ImportKitti(const KittiRequest& request);

}  // namespace v2vouch::sim
