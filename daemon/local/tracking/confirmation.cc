// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

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
// Boxes on the ground name a vehicle at a place; one alone may be false.
constexpr int kSureBoxes = 2;

}  // namespace

int Tracker::Hits(std::size_t track) const { return tracks_[track].support.hits(); }

// Whether a track may be published for the first time.
bool Tracker::IsConvincing(std::size_t track) const {
  const LocalTrack& shown = tracks_[track];
  const Hidden& hidden = hidden_[track];
  if (shown.existence < config_.confirm_existence || Hits(track) < config_.confirm_hits) {
    return false;
  }
  if (shown.camera_hits() + hidden.moving_hits + shown.object_hits() < 2) return false;
  const double most_m = hidden.has_range ? config_.max_position_sigma_m
                                         : std::min(kMostGuess_m, config_.max_position_sigma_m);
  if (LargestSigma(hidden.filter.position_covariance()) > most_m) return false;
  if (shown.object_hits() >= kSureBoxes) return true;
  if (MayBeOwnBody(track) || IsTransparent(track)) return false;
  if (shown.camera_hits() > 0) return shown.radar_hits() > 0 || !hidden.is_far;
  const bool is_in_sight = hidden.clear_hits >= kClearHits;
  const bool is_missing = hidden.not_pictured >= kMissingPictures;
  if (is_in_sight && !is_missing) return true;
  return shown.radar_hits() >= kLastingHits &&
         ToSeconds(hidden.last_hit - shown.start) >= kLastingImage_s;
}

}  // namespace v2vouch
