// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/behaviour/confirmation.h"
#include "sim/metrics/scoring.h"

namespace v2vouch::evaluation {

/// The list's visibility flag against truth, over matched tracks and instants.
struct VisibilityTable {
  /// [said][true], both Sighting.
  std::array<std::array<std::int64_t, 3>, 3> count{};

  [[nodiscard]] std::int64_t said(Sighting s) const;
  [[nodiscard]] std::int64_t truly(Sighting s) const;
  [[nodiscard]] std::int64_t right(Sighting s) const;
  [[nodiscard]] std::int64_t total() const;
  /// NaN where nothing was counted.
  [[nodiscard]] double share_right() const;
  [[nodiscard]] double share_right_of_said(Sighting s) const;
  [[nodiscard]] double share_found_of_true(Sighting s) const;
};

/// Heading errors of a list's tracks that are older than a second.
struct HeadingFigures {
  static constexpr double kLeastAge_s = 1.0;
  std::int64_t samples = 0;
  std::int64_t reversed = 0;  ///< Samples with more than 90 degrees of error.
  int tracks = 0;
  int flips = 0;          ///< Times a track went from below 90 degrees of error to above.
  int born_reversed = 0;  ///< Tracks already reversed at the age of a second.
  double rms_moving_rad = kNoValue;    ///< Of the error, vehicles that truly move ...
  double rms_standing_rad = kNoValue;  ///< ... and that stand.
};

/// Position error of visible vehicles of one kind, as ListScore's localisation.
struct LocalisationPart {
  double rms_m = kNoValue;
  double ratio = kNoValue;  ///< Over the bound's RMS for the same pairs.
  double seconds = 0.0;     ///< Vehicle-seconds.
};

struct ListBehaviour {
  VisibilityTable visibility;
  HeadingFigures heading;
  LocalisationPart moving, standing;  ///< Below 0.5 m/s, by truth, is standing.
};

struct Behaviour {
  ListBehaviour local, priority;
  Confirmation confirmation;
};

/// How a list behaves beside its distance from truth, from the pairs of its score. Truth and list
/// are compared at the list's own time.
///
/// A list says "visible" both of what it knows to be in clear view and of what it cannot tell, so
/// that column also counts its unknowns.
ListBehaviour JudgeList(const RunLog& log, const std::vector<Timestamp>& grid, const Bound& bound,
                        const ListScore& score, const ScoringSettings& settings);

}  // namespace v2vouch::evaluation
