// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/common/data/input.h"

namespace v2vouch {

/// What stage A of a calibration reads of a drive: the car's own sensors, each in order of its
/// stamps. There is no place for a BSM in it: what a stranger says can never move an extrinsic.
struct DriveLog {
  std::vector<EgoMotion> motion;
  std::vector<GnssFix> fixes;
  std::vector<RadarScan> scans;
  std::vector<CameraDetections> pictures;

  void Keep(Input input);  ///< A BSM and what else has no place here is passed over.
  void SortByStamp();      ///< What was received first stays first among equals.
};

}  // namespace v2vouch
