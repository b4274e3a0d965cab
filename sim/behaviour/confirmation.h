// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/metrics/scoring.h"

namespace v2vouch::evaluation {

/// How long one vehicle that the sensors could see took to come into LOCAL.
struct FirstListing {
  std::int64_t object = 0;
  bool is_standing = false;  ///< At its first look.
  bool is_listed = false;
  int looks = 0;               ///< Own-sensor frames that could have shown it, up to the listing.
  double expected_hits = 0.0;  ///< Sum of their detection probabilities.
  double delay_s = 0.0;        ///< From the first of them to the listing.
};

/// Confirmation delay, means over vehicles.
struct Confirmation {
  std::vector<FirstListing> vehicles;  ///< By object; those with a look and at least a second left.

  struct Mean {
    int vehicles = 0;
    int listed = 0;
    double looks = kNoValue;  ///< Over the listed ones, as the rest; NaN where none is.
    double expected_hits = kNoValue;
    double delay_s = kNoValue;
    double looks_median = kNoValue;
  };
  enum class Of { kAll, kMoving, kStanding };
  [[nodiscard]] Mean Average(Of which) const;
};

/// Counts looks from the beginning of the log: a look is one frame of any own sensor that reached
/// the log, taken while that sensor's detection probability of the vehicle, by TRUTH, is at least
/// one half, at any range (a count that began at the disc's edge would find most vehicles listed
/// already). Listed: matched to a track of a LOCAL list (GOSPA's assignment to all vehicles, as the
/// scores use) whose centre is within half the vehicle's length and 2 m; looks count when received
/// by then.
Confirmation JudgeConfirmation(const RunLog& log, const ScoringSettings& settings);

}  // namespace v2vouch::evaluation
