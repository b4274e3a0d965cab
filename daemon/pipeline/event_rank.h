// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include "daemon/pipeline/timeline.h"

namespace v2vouch {

template <class... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};

/// Rank of the kinds of source at equal times: the ego's motion first, so that a frame of the same
/// instant finds it; claims last, so that they meet the newest tracks.
enum Rank { kEgoRank, kGnssRank, kRadarRank, kCameraRank, kObjectsRank, kClaimRank };

inline bool HasFrame(const TimelineInput& input) {
  return std::holds_alternative<RadarScan>(input) ||
         std::holds_alternative<CameraDetections>(input) ||
         std::holds_alternative<ObjectList>(input);
}

inline bool IsLocal(const TimelineInput& input) {
  return HasFrame(input) || std::holds_alternative<EgoMotion>(input);
}

}  // namespace v2vouch
