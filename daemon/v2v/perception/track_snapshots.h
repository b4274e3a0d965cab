// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "daemon/common/base/scratch.h"
#include "daemon/common/base/time.h"
#include "daemon/common/data/track.h"
#include "daemon/common/models/ctra.h"

namespace v2vouch {

/// Frames in which the sensors had no more than a part of a vehicle.
struct PartialObservation {
  std::uint64_t track_id = 0;
  Timestamp last{};                ///< The last of them ...
  std::optional<Timestamp> whole;  ///< ... and the first frame since that had the whole vehicle.
  Timestamp first{};               ///< The first of this phase.
};

/// A confirmed LOCAL track as of the newest frame.
struct TrackSnapshot {
  LocalTrack track;  ///< Partially observed of late: its covariance widened by what that may hide.
  bool is_sure = false;  ///< The sensors alone are sure enough of it for PRIORITY.
  bool is_hit = false;   ///< Given a measurement in the newest frame.
  std::optional<PartialObservation> partial{};
  bool is_partial = false;          ///< Partially observed so lately that its state may be off.
  bool is_briefly_partial = false;  ///< ... for no longer than something takes to cover it.
  bool is_doubtful = false;         ///< ... and not observed completely for long enough since.
};

/// What the sensors know, for the V2V side: all confirmed LOCAL tracks of the newest frame, ordered
/// by id. A vehicle of which only a part shows (truncated by the field of view, or occluded) drags
/// its track along; such tracks are marked, and stay so until they were observed whole for as long.
/// Copyable: part of every checkpoint.
class TrackSnapshots {
 public:
  static constexpr double kMaxAge_s = 0.5;  ///< Older tracks are not compared with anything.

  /// A new frame begins; what was known of partial observations is carried over.
  void Begin(Timestamp stamp);
  struct Observed {
    bool is_sure = false;
    bool is_hit = false;
    bool is_partial = false;  ///< In this frame.
  };
  /// Adds the next track, in order of id.
  void Add(const LocalTrack& track, const Observed& observed);

  [[nodiscard]] std::span<const TrackSnapshot> tracks() const { return tracks_; }
  [[nodiscard]] Timestamp stamp() const { return stamp_; }
  /// Null where there is no such track; `local_id` 0 is none.
  [[nodiscard]] const TrackSnapshot* Find(std::uint64_t local_id) const;

 private:
  Timestamp stamp_{};
  std::vector<TrackSnapshot> tracks_;
  Scratch<std::vector<PartialObservation>> carried_;
};

}  // namespace v2vouch
