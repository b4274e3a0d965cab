// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace v2vouch::bench {

/// One vehicle at one instant, true or as detected; plane of the road, SI, radians.
struct VehiclePose {
  int id = -1;  ///< Of a true vehicle; -1 for a detection.
  double x_m = 0.0;
  double y_m = 0.0;
  double speed_mps = 0.0;
  double yaw_rad = 0.0;
  double yaw_rate_radps = 0.0;
};

struct Frame {
  int number = 0;
  double time_s = 0.0;
  std::vector<VehiclePose> truth;
  std::vector<VehiclePose> detections;
};

using Recording = std::vector<Frame>;  ///< Time rises strictly.

/// Reads a CSV file, plain or gzip, with the columns
///
///     frame,t,kind,id,x,y,v,yaw,yaw_rate     kind: T truth, D detection
///
/// in any order, further ones ignored. Rows of one frame stand together and share its time.
/// @return nullopt with `error` naming file and line: unreadable, a number that is none, a kind
///   that is neither, frames or times that do not rise, no frame at all.
std::optional<Recording> ReadRecording(const std::string& path, std::string& error);

/// @return false with `error` when the file cannot be written.
/// None of `inputs` is overwritten.
bool WriteRecording(const Recording& recording, const std::string& path, std::string& error,
                    std::span<const std::string> inputs = {});

/// The same traffic on a road turned by `angle_rad` about the origin. Quarter turns are exact.
Recording Rotated(const Recording& recording, double angle_rad);

}  // namespace v2vouch::bench
