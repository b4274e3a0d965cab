// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/common/data/vehicle.h"

namespace v2vouch::ladder {

/// What truth takes away from a drive's sensor data. Scans and pictures stay, so the lists of all
/// rungs have the same times.
enum class Rung {
  /// Only detections that come from a road user: no scenery, images, clutter, false boxes.
  kExistence,
  /// ... of one of them: nothing else can be taken for it, nor it for anything else.
  kAssociation,
  /// ... and each vehicle is a point: one detection of its true centre in each scan and picture
  /// that
  /// had any of it, with the data sheet's noise. For `tracking.point_targets: true`.
  kExtent,
};

/// Writes the log `in` as `rung` has it to `out`; for kAssociation one log for each road user with
/// ten detections or more, `out` with `.ID` before its ending, without BSMs.
/// @param written the files written.
/// @return damaged stretches of `in`, which were skipped; nullopt with `error` set when a file
/// cannot be read or written, or `in` has no TRUTH.
std::optional<std::int64_t> Sift(const std::string& in, const VehicleConfig& vehicle, Rung rung,
                                 const std::string& out, std::vector<std::string>& written,
                                 std::string& error);

}  // namespace v2vouch::ladder
