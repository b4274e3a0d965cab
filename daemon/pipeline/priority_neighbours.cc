// SPDX-License-Identifier: Apache-2.0
// Whether a sender may be a vehicle that no sensor sees, just before or behind the LOCAL track that
// it agrees with: in a queue both stand still, and a bias of half the headway fits either.
#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/pipeline/priority_evidence.h"
#include "daemon/pipeline/priority_perception.h"

namespace v2vouch {
namespace {

constexpr double kGap_m = 2.0;      // Between bumpers of two that stand in a queue ...
constexpr double kHeadway_s = 0.8;  // ... and so much more where they drive.

}  // namespace

PriorityPerception::UnseenNeighbours PriorityPerception::LookBeside(
    const Link& link, const LocalFrame& frame, const VisibilityMap& map) const {
  UnseenNeighbours unseen;
  const PairTable::Pair* pair = pairs_.AssignedTo(link.sender);
  const Sensed* sensed = pair == nullptr ? nullptr : FindSensed(pair->track_id);
  if (sensed == nullptr) return unseen;
  unseen.track_id = pair->track_id;
  const StateVector& track = sensed->track.state_O.mean;
  // Of a track that has never moved the direction is a guess; the sender knows its own.
  const double yaw_rad = link.last.has_course ? link.last.yaw_rad : track[kYaw];
  Occluder footprint = ClaimedFootprint(link, track.head<2>(), yaw_rad);
  const double apart_m = 0.5 * (sensed->track.extent.length_m + footprint.length_m) + kGap_m +
                         kHeadway_s * std::abs(track[kSpeed]);
  const Eigen::Vector2d ahead(std::cos(yaw_rad), std::sin(yaw_rad));
  for (std::size_t i = 0; i < unseen.offsets_O.size(); ++i) {
    const Eigen::Vector2d offset_O = (i == 0 ? apart_m : -apart_m) * ahead;
    footprint.centre_O = track.head<2>() + offset_O;
    // A LOCAL track there is asked for itself.
    const bool is_tracked = std::ranges::any_of(sensed_, [&](const Sensed& other) {
      return other.track.id != pair->track_id && other.is_hit &&
             AreClose(footprint, other.track, 0.0);
    });
    if (is_tracked) continue;
    const bool is_clear =
        ClearDetection(footprint, frame, map, settings_->vehicle, ClearTo::kAnySensor, 0.0)
            .has_value();
    if (is_clear && !map.HasStandingReturn(footprint.centre_O, kStandingReach_m)) continue;
    unseen.offsets_O[i] = offset_O;
  }
  return unseen;
}

double PriorityPerception::MarginOverUnseen(const Link& link, const PairTable::Pair& pair) {
  if (link.unseen.track_id != pair.track_id) return 0.0;  // Not looked yet.
  double margin = std::numeric_limits<double>::infinity();
  for (const auto& offset_O : link.unseen.offsets_O) {
    if (!offset_O) continue;
    margin = std::min(margin, pair.evidence.LevelBeside(*offset_O) - pair.evidence.level());
  }
  return margin;
}

}  // namespace v2vouch
