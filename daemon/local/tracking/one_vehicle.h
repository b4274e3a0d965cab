// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "daemon/common/base/scratch.h"
#include "daemon/local/tracking/place_index.h"
#include "daemon/local/tracking/track_table.h"

namespace v2vouch {

/// The rules by which two tracks are one vehicle, applied after every frame. They compare each
/// track with its seniors (listed before not, named before not, of more pictures and boxes, older
/// before younger) and keep their count in TrackEvidence; nothing outlasts a call but that. Two
/// boxes of one frame of objects are two vehicles, however close they stand.
///
/// - Two vehicles cannot stand in one place: of two tracks with overlapping footprints and one
///   velocity the junior ends after 0.1 s, or 0.2 s where it is listed.
/// - A track that lives on clusters out of its senior's box ends after five of them.
/// - A lorry's rear axle reflects ten metres behind its face and starts a track of its own. It
///   moves with the lorry, on its axis, as far behind the near face as such a vehicle may reach,
///   and no picture shows both: it ends, and the lorry is lengthened.
class OneVehicle {
 public:
  /// @param dt_s since the last frame.
  void Apply(double dt_s, TrackTable& table);

 private:
  void EndDuplicates(double dt_s, TrackTable& table) const;
  void JoinParts(double dt_s, TrackTable& table) const;

  Scratch<PlaceIndex> places_;  // Of the tracks' centres.
};

/// Whether a place (O, [m]) lies in the box of a listed vehicle other than track i, or where its
/// end may be.
bool IsInAnothersBox(const TrackTable& table, std::size_t i, const Eigen::Vector2d& p_O);

}  // namespace v2vouch
