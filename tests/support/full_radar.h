// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/common/data/input.h"
#include "tests/support/synthetic_drive.h"

namespace v2vouch::testing {

/// What fills a sensor: as many detections as a message holds.
enum class FullKind {
  kMoving,    ///< Anywhere in the field of view, any Doppler within 30 m/s: interference.
  kRing,      ///< On one circle 30 m away, any Doppler.
  kStanding,  ///< Anywhere, standing.
};

inline constexpr int kFullScan = 1024;  ///< Returns.
inline constexpr int kFullFrame = 512;  ///< Boxes.

/// The drive's inputs with every radar scan from `from_s` on filled up to kFullScan returns;
/// seeded.
std::vector<Input> WithFullRadars(const SyntheticDrive& drive, FullKind kind, double from_s = 0.0);
/// With every picture filled up to kFullFrame boxes.
std::vector<Input> WithFullCameras(const SyntheticDrive& drive);

}  // namespace v2vouch::testing
