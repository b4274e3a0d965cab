// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/drive_log.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace v2vouch {

void DriveLog::Keep(Input input) {
  if (auto* scan = std::get_if<RadarScan>(&input)) {
    scans.push_back(std::move(*scan));
  } else if (auto* picture = std::get_if<CameraDetections>(&input)) {
    pictures.push_back(std::move(*picture));
  } else if (const auto* ego = std::get_if<EgoMotion>(&input)) {
    motion.push_back(*ego);
  } else if (const auto* fix = std::get_if<GnssFix>(&input)) {
    fixes.push_back(*fix);
  }
}

void DriveLog::SortByStamp() {
  const auto by_stamp = [](auto& messages) {
    std::ranges::stable_sort(messages, {}, [](const auto& m) { return m.stamp; });
  };
  by_stamp(motion);
  by_stamp(fixes);
  by_stamp(scans);
  by_stamp(pictures);
}

}  // namespace v2vouch
