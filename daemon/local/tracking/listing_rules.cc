// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/listing_rules.h"

#include <algorithm>
#include <cmath>

#include "daemon/local/tracking/candidates.h"
#include "daemon/local/tracking/own_body.h"

namespace v2vouch {
namespace {

// How long a hidden track is kept for each second it was known.
constexpr double kHoldPerKnown = 3.0;
constexpr double kLeastHold_s = 0.3;
constexpr double kCoastingSince_s = 0.5;
// Tracks that were never believed go below this.
constexpr double kForget = 1e-5;
// In view, a vehicle is missed for no longer than this.
constexpr double kOverdue_s = 0.7;
// Nor, partly hidden, for longer than this if sensors ought to have seen it so often since then:
// existence that is as good as certain would take far longer to fall.
constexpr double kSilent_s = 0.4;
constexpr double kMostLooks = 1.5;
// After the first, which is not asked. A radar sees mirror images behind rails and facades, where
// it cannot see at all.
constexpr int kClearHits = 2;
// A range that only a camera's bottom edges give must be at least this good.
constexpr double kMostGuess_m = 2.5;
// What no picture shows although it should is a multipath ghost, or a vehicle that the camera
// is blind for. Ghosts come and go within tenths of a second.
constexpr int kMissingPictures = 2;
constexpr double kLastingImage_s = 1.0;
constexpr int kLastingHits = 15;
// Pictures of what so many looks of a clear radar saw nothing of are false.
constexpr int kEmptyLooks = 6;
// Boxes on the ground name a vehicle at a place; one alone may be false.
constexpr int kSureBoxes = 2;

// A sensor that sees clearly saw through it.
bool IsNothing(const LocalTrack& track, const TrackEvidence& evidence) {
  return IsTransparent(track, evidence) || evidence.empty_looks >= kEmptyLooks;
}

// Nothing is known to hide it, and no sensor has seen it for a while.
bool IsOverdue(const LocalTrack& track, const TrackEvidence& evidence, Timestamp now) {
  const double silent_s = ToSeconds(now - evidence.last_hit);
  if (silent_s > kSilent_s && evidence.missed_looks > kMostLooks) return true;
  return track.visibility == Visibility::kVisible && silent_s > kOverdue_s;
}

}  // namespace

bool ListingRules::MayCoast(const LocalTrack& track, const TrackEvidence& evidence,
                            Timestamp now) const {
  const double silent_s = ToSeconds(now - evidence.last_hit);
  // What was seen for a moment only is not waited for.
  const double known_s = ToSeconds(evidence.last_hit - track.start);
  // Boxes alone leave the velocity open.
  const bool has_velocity = track.radar_hits() + track.object_hits() > 0;
  const double hold_s =
      has_velocity ? std::min(config_.hidden_hold_s, kHoldPerKnown * known_s + kLeastHold_s)
                   : kLeastHold_s;
  if (track.visibility != Visibility::kVisible && silent_s > hold_s) return false;
  return silent_s <= kCoastingSince_s || IsWorthListing(track, evidence);
}

void ListingRules::Judge(Timestamp now, LocalTrack& track, TrackEvidence& evidence) const {
  if (!track.is_confirmed && IsConvincing(track, evidence)) {
    track.is_confirmed = true;
    evidence.clutter_cell = -1;  // It has come to something.
  } else if (track.is_confirmed &&
             (track.existence < config_.keep_existence || !IsWorthListing(track, evidence) ||
              IsNothing(track, evidence) || IsOverdue(track, evidence, now))) {
    track.is_confirmed = false;
  }
  const bool was_believed = track.support.hits() >= config_.confirm_hits;
  if (track.existence < (was_believed ? config_.delete_existence : kForget)) {
    evidence.is_ended = true;
  }
}

// Existence must outweigh the error that the cut-off metric would find.
bool ListingRules::IsWorthListing(const LocalTrack& track, const TrackEvidence& evidence) const {
  const double c2 = config_.list_cutoff_m * config_.list_cutoff_m;
  const double m = evidence.filter.position_covariance().trace();
  const double error = m > 0.0 ? -m * std::expm1(-c2 / m) : 0.0;
  return track.existence * 2.0 * (c2 - error) > c2;
}

// Whether a track may be listed for the first time.
bool ListingRules::IsConvincing(const LocalTrack& track, const TrackEvidence& evidence) const {
  if (track.existence < config_.confirm_existence || track.support.hits() < config_.confirm_hits) {
    return false;
  }
  if (track.camera_hits() + evidence.moving_hits + track.object_hits() < 2) return false;
  const double most_m = evidence.has_range ? config_.max_position_sigma_m
                                           : std::min(kMostGuess_m, config_.max_position_sigma_m);
  if (LargestSigma(evidence.filter.position_covariance()) > most_m) return false;
  if (track.object_hits() >= kSureBoxes) return true;
  if (MayBeOwnBody(track, evidence) || IsNothing(track, evidence)) return false;
  if (track.camera_hits() > 0) return track.radar_hits() > 0 || !evidence.is_far;
  const bool is_in_sight = evidence.clear_hits >= kClearHits;
  const bool is_missing = evidence.not_pictured >= kMissingPictures;
  if (is_in_sight && !is_missing) return true;
  return track.radar_hits() >= kLastingHits &&
         ToSeconds(evidence.last_hit - track.start) >= kLastingImage_s;
}

}  // namespace v2vouch
