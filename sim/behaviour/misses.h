// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/metrics/scoring.h"

namespace v2vouch::evaluation {

/// Why PRIORITY lacks a vehicle that the bound holds. The first that applies:
enum class MissReason {
  kElsewhere,      ///< Its sender is listed, but not within the cutoff of the truth.
  kWithdrawn,      ///< Its sender is SUSPECT or REVOKED.
  kBridgeEnded,    ///< Hidden, and its sender was listed at some time.
  kNeverBridged,   ///< Hidden, and its sender was never listed.
  kNoLocalTrack,   ///< Visible by truth, but LOCAL has no track of it.
  kNotFollowed,    ///< LOCAL has it; the V2V list lacks its sender.
  kUnknownSender,  ///< LOCAL has it; its sender's messages do not (yet) continue each other.
  kNotValidated,   ///< LOCAL has it; the sender is a CANDIDATE and not more.
};
const char* MissReasonKey(MissReason reason);  ///< "elsewhere", "withdrawn", ...

/// All instants of one vehicle that were missed for one reason.
struct Miss {
  std::int64_t vehicle = 0;  ///< TruthObject::id.
  MissReason reason = MissReason::kElsewhere;
  std::string check;     ///< kWithdrawn: what the sender was last reported for; else empty.
  double seconds = 0.0;  ///< Vehicle-seconds.
  double first_s = 0.0;  ///< Of the first such instant, since the first truth sample.
};

/// Explains the excess missed vehicle-seconds of a run's PRIORITY score: the sum of all `seconds`
/// is its excess_missed_seconds. Ordered by vehicle, then by time of the first instant.
/// @param local and @param priority scores of the same run, each against its own scope.
std::vector<Miss> ExplainMisses(const RunLog& log, const std::vector<Timestamp>& grid,
                                const Bound& bound, const ListScore& local,
                                const ListScore& priority, const ScoringSettings& settings);

}  // namespace v2vouch::evaluation
