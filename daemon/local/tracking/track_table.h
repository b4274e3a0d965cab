// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/common/base/reason.h"
#include "daemon/common/base/scratch.h"
#include "daemon/common/data/track.h"
#include "daemon/local/tracking/listing_rules.h"
#include "daemon/local/tracking/track_evidence.h"
#include "daemon/local/tracking/tracker_config.h"

namespace v2vouch {

/// The tracks: what each one shows (LocalTrack) and what is known of it (TrackEvidence), with the
/// time that they are valid for and the faults of this step. States in O, SI units. Between two
/// steps the tracks are in order of their ids, which is the order of their starts; those that a
/// step starts stand at the end. At most max_tracks of them, of which kMostGuesses are not listed
/// (beside a bench's). Copyable: a copy is a checkpoint.
class TrackTable {
 public:
  /// More tracks than this are not started by one frame.
  static constexpr std::size_t kMostNewcomers = 64;
  static constexpr std::size_t kMostDetections = 4096;  ///< Of one frame, as an id can hold them.

  /// One track. Valid until the next Start, EndStep or Predict.
  struct Row {
    LocalTrack& track;
    TrackEvidence& evidence;
  };
  struct ConstRow {
    const LocalTrack& track;
    const TrackEvidence& evidence;
  };

  /// A track that a radar started and that ended without having been listed.
  struct Nothing {
    int clutter_cell = -1;
    int radar_hits = 0;
  };

  explicit TrackTable(const TrackerConfig& config);

  /// Brings every track to `stamp` (>= the last one), forgets the faults of the last step and drops
  /// tracks that have ended: not to be waited for (ListingRules::MayCoast), or not finite.
  /// @return the time since the last step [s], 0 for an empty table.
  double Predict(Timestamp stamp);

  /// A track of the detection `index` of a frame of now. @return false, with kTrackTableFull as
  /// fault, when the table is full.
  bool Start(const TrackFilter& filter, SensorKey sensor, std::size_t index, double existence);
  /// The track was given a measurement of now.
  void NoteHit(std::size_t i, SensorKey sensor, bool is_echo = false);
  /// A sensor has named the track's class. Votes fade; the class changes for one that is clearly
  /// better supported.
  void NoteClass(std::size_t i, ObjectClass object_class, double score);
  /// Ends a track whose filter failed.
  void Fail(std::size_t i);
  void AddFault(Reason reason) { faults_.push_back(reason); }

  /// After a frame: shows the new states; lists and ends by ListingRules. Ended tracks stay in
  /// place until EndStep.
  void Judge();
  /// Removes what has ended and the least likely of too many that are not listed; restores the
  /// order of ids.
  void EndStep();
  void RemoveEnded();

  [[nodiscard]] std::size_t size() const { return tracks_.size(); }
  Row operator[](std::size_t i) { return {tracks_[i], evidence_[i]}; }
  ConstRow operator[](std::size_t i) const { return {tracks_[i], evidence_[i]}; }
  Row back() { return (*this)[size() - 1]; }
  [[nodiscard]] std::span<const LocalTrack> tracks() const { return tracks_; }
  [[nodiscard]] std::span<const Reason> faults() const { return faults_; }
  /// What has ended so since the last Predict began.
  [[nodiscard]] std::span<const Nothing> came_to_nothing() const { return came_to_nothing_; }
  [[nodiscard]] Timestamp now() const { return now_; }
  [[nodiscard]] const FilterSettings& settings() const { return settings_; }

  /// What a frame of so many detections holds beyond the vehicles that are listed and a crowd of
  /// new ones: clutter, however little the sensor promised. Interference would else be listed as
  /// vehicles everywhere. May be below 0.
  [[nodiscard]] double CrowdOf(std::size_t detections) const;

  /// Identity of a track, positive in 63 bits and in the order of time: time in units of 512 us,
  /// kind of sensor (2 bits), its index (5) and the index of the detection that started it (12).
  static std::uint64_t PackId(Timestamp stamp, SensorKey sensor, std::size_t index);

 private:
  /// @return false where the state is not finite; the track has ended.
  bool Show(std::size_t i);
  [[nodiscard]] std::uint64_t FreeId(SensorKey sensor, std::size_t index) const;
  void EndUnlikely();

  std::size_t max_tracks_;
  double survival_per_s_;
  FilterSettings settings_;
  ListingRules rules_;
  Timestamp now_{};
  std::vector<LocalTrack> tracks_;
  std::vector<TrackEvidence> evidence_;  // Of the track with the same index.
  std::vector<Reason> faults_;
  std::vector<Nothing> came_to_nothing_;
  Scratch<std::vector<std::size_t>> guesses_;
};

}  // namespace v2vouch
