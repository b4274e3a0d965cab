// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "sim/scorecard/first_listing.h"
#include "sim/scorecard/lead.h"

namespace v2vouch::evaluation {

/// Position errors [m] of matched vehicles that are visible, within `near_m`.
struct ErrorParts {
  Sample all;
  Sample moving, standing;  ///< In clear sight; standing is below 0.5 m/s.
  Sample partly_hidden;     ///< Visible, not in clear sight.
  Sample plain;             ///< Cars and vans in plain sight of a radar and a camera.
  Sample cars, vans, lorries, motorcycles;  ///< By true class; buses are lorries here.
};

/// What is special about lorries and buses: their length is not known at first.
struct LorryFigures {
  Sample near_face_m;     ///< Nearest point of the listed box minus of the true one, by range.
  Sample length_error_m;  ///< Listed minus true.
};

/// Squared normalised position errors; 2 on average and 1.39 in the median for an honest list.
struct ConsistencyFigures {
  static constexpr double kOneInHundred = 9.21;  ///< An honest list is above in 1 % of samples.
  Sample nees;
};

/// Listed entries, inside the disc, with their centre more than 3 m from every true road user's
/// box: vehicles that nobody could see.
struct UnseenFigures {
  std::int64_t entries = 0;
  std::int64_t coasting = 0;  ///< Entries without an own sensor's hit for more than 0.3 s.
  int ids = 0;                ///< Distinct tracks among them.
  int lasting_ids = 0;        ///< ... that coasted so for more than half a second.
  double seconds = 0.0;
};

/// Vehicles that PRIORITY could bridge, by the time since they were last visible.
struct BridgeFigures {
  std::int64_t samples = 0;
  std::int64_t kept = 0;
  std::int64_t covered = 0;  ///< Samples whose bridging budget, when last visible, lasts.
  std::int64_t covered_kept = 0;
  Sample error_m;
};

struct Scorecard {
  ListKind kind = ListKind::kLocal;
  ScorecardSettings settings;
  std::int64_t instants = 0;
  std::int64_t lists = 0;  ///< Instants that had a list.

  ErrorParts position;
  LorryFigures lorry;
  Sample velocity_mps;                      ///< Length of the velocity error.
  Sample yaw_moving_rad, yaw_standing_rad;  ///< Size of the error, 0..pi.
  ConsistencyFigures visible, hidden;
  /// Vehicles in scope within near_m, summed over instants, and those without a track.
  struct Missed {
    std::int64_t of = 0;
    std::int64_t missed = 0;
    [[nodiscard]] double share() const;
  };
  Missed missed_visible, missed_plain;
  std::int64_t false_entries = 0;  ///< In the disc, matched to no vehicle in scope.
  UnseenFigures unseen;
  int switches = 0;  ///< Visible vehicles in the disc followed by another track than the last.
  FirstListings first_listing;
  LeadFigures lead;
  // Of vehicles that send BSMs; for PRIORITY.
  BridgeFigures hidden_1_2_s, hidden_3_4_s, hidden_1_4_s;
  std::int64_t validated_of = 0;  ///< Instants of senders in clear sight for 3 s, within near_m.
  std::int64_t validated = 0;     ///< ... that are listed.

  [[nodiscard]] double false_per_list() const;
};

/// Judges one list of a run at ten lists a second; see MakeScenes() for which.
Scorecard JudgeScorecard(const RunLog& log, ListKind kind, const ScorecardSettings& settings);

/// LOCAL's and PRIORITY's.
struct Scorecards {
  Scorecard local, priority;
};
Scorecards JudgeScorecards(const RunLog& log, const ScorecardSettings& settings);

}  // namespace v2vouch::evaluation
