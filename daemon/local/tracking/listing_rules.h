// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/time.h"
#include "daemon/common/data/track.h"
#include "daemon/local/tracking/track_evidence.h"
#include "daemon/local/tracking/tracker_config.h"

namespace v2vouch {

/// When a track is listed, when it is not listed any more and when it ends. Pure: judges one track
/// by what it shows and what is known of it, at a time; keeps the settings alone.
///
/// - A track is listed if that lowers expected squared GOSPA (p = 2): with D the expected
///   squared error cut off at c^2 (c = list_cutoff_m) and m the trace of the position covariance,
///   where its existence r
///
///       r > c^2 / (2 (c^2 - D)),   D = m (1 - exp(-c^2 / m))
///
///   A coasting track that no longer fulfils this ends.
/// - Nothing is listed that was not seen twice by a camera or in motion.
/// - Two kinds of tracks without a picture are not listed: one that has only ever been at
///   the car itself (water on a radome, a tow bar), and one through which a camera sees another
///   vehicle.
class ListingRules {
 public:
  explicit ListingRules(const TrackerConfig& config) : config_(config) {}

  /// Whether a track without a measurement is waited for: out of sight for 0.3 s and three times as
  /// long as it was known (at most hidden_hold_s; cameras alone: 0.3 s), and worth listing by then.
  [[nodiscard]] bool MayCoast(const LocalTrack& track, const TrackEvidence& evidence,
                              Timestamp now) const;

  /// Lists the track, takes it off the list or ends it, after a frame.
  void Judge(Timestamp now, LocalTrack& track, TrackEvidence& evidence) const;

 private:
  [[nodiscard]] bool IsWorthListing(const LocalTrack& track, const TrackEvidence& evidence) const;
  [[nodiscard]] bool IsConvincing(const LocalTrack& track, const TrackEvidence& evidence) const;

  TrackerConfig config_;
};

}  // namespace v2vouch
