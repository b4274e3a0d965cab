// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "daemon/common/base/time.h"
#include "daemon/local/tracking/body_height.h"
#include "daemon/local/tracking/glances.h"
#include "daemon/local/tracking/track_filter.h"

namespace v2vouch {

/// What is known of a track beside what LocalTrack shows: its filter, and what speaks for and
/// against a vehicle of its own in that place. One record per track, at the same index of the
/// TrackTable, copied with every checkpoint. Positions in O [m]; a hit is a measurement that the
/// track was given by one frame of one sensor. Each group names who writes it.
struct TrackEvidence {
  TrackFilter filter;

  // Existence: TrackTable, and the frames' updates in Tracker.
  Timestamp last_hit{};
  double missed_looks = 0.0;  ///< Detections that were expected since then.
  Timestamp borne_out{};      ///< Last hit that cannot be the second echo of another vehicle.
  double proven = 0.0;        ///< Existence by pictures, boxes and motion alone.
  bool is_certain = false;    ///< Started by a bench's pose or box: however unlikely, it may stay.
  bool is_ended = false;      ///< Leaves the table at the end of this step.
  std::array<double, 8> class_votes{};        ///< Scores by ObjectClass, older ones less.
  ObjectClass named = ObjectClass::kUnknown;  ///< What most of them say.

  // Radar: Tracker::UpdateRadar.
  Eigen::Vector2d reflection_O = Eigen::Vector2d::Zero();    ///< Last cluster it was given ...
  Eigen::Vector2d first_moving_O = Eigen::Vector2d::Zero();  ///< Where it first moved.
  Timestamp reflected{};                                     ///< ... and when.
  int clear_hits = 0;                                        ///< From where the radar can see.
  int moving_hits = 0;                                       ///< With a Doppler of their own.
  int empty_looks = 0;         ///< Scans in a row that saw nothing where only pictures show it.
  int clutter_cell = -1;       ///< Of its first cluster, in ClutterMap, until it is listed.
  bool has_travelled = false;  ///< Moving hits lie apart.

  // Camera: Tracker::UpdateCamera.
  int not_pictured = 0;  ///< Pictures that ought to have shown it.
  BodyHeight height;
  bool is_far = false;  ///< Beyond camera_birth_range_m at its last box.

  // A range that only cameras have guessed: StandingReturns::LearnRange.
  bool has_range = true;
  Glances glances;       ///< Of a track without a range.
  int moving_there = 0;  ///< Pictures in a row with something moving where it was guessed.

  // Part of the own car, or nothing solid: own_body.h.
  int apart_hits = 0;     ///< Radar hits away from the car's own body, less those at it.
  bool is_apart = false;  ///< It has been away from there.
  int seen_through = 0;   ///< Pictures that showed a vehicle behind it.

  // Part of another track's vehicle: OneVehicle.
  double overlap_s = 0.0;  ///< How long its senior has been in the same place.
  double part_s = 0.0;     ///< How long it could be the far end of a lorry or bus.
  double convoy_s = 0.0;   ///< How long it has followed closer than anybody drives.
  int borrowed = 0;        ///< Hits out of its senior's box, own ones taken off twice.
};

}  // namespace v2vouch
