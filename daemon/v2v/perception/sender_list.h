// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "daemon/common/data/outputs.h"
#include "daemon/v2v/intake/intake.h"
#include "daemon/v2v/perception/v2v_perception.h"

namespace v2vouch {

/// Where the ego's footprint is on the globe. Requires alignment.is_ready().
EgoPlace PlaceOf(const Alignment& alignment, const EgoState& ego, const VehicleConfig& vehicle);

/// TRACKS_V2V: every sender as heard, its own filtered claim carried forward to the list's time and
/// brought into O, with its trust and bias (of its vehicle's filter where it has one, else as last
/// settled). Diagnostic, so no other list waits for it: a list of many senders is made in pieces,
/// one with each input that is no frame. Empty where the alignment is not ready.
class SenderList {
 public:
  static constexpr std::size_t kPiece = 32;  ///< Senders of one piece.

  [[nodiscard]] bool is_open() const { return is_open_; }
  [[nodiscard]] bool is_new() const { return next_ == 0; }
  /// Begins a list of those known now. `head`: everything but the tracks.
  void Open(const TrackList& head, std::span<const SenderTrack> senders);
  /// The next piece, of senders that are still known.
  /// @return whether that was the last: then the list is to be taken.
  bool Continue(const BsmIntake& intake, const V2vPerception& priority, const BiasReport& settled);
  void Take(TrackList& list) { std::swap(list, list_); }

 private:
  bool is_open_ = false;
  TrackList list_;
  std::vector<SenderId> senders_;
  std::size_t next_ = 0;
};

}  // namespace v2vouch
