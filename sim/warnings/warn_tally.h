// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace v2vouch::evaluation {

/// What one consumer's warnings came to, over all kinds and over runs; see WarnCounts.
struct ConsumerTally {
  int true_count = 0;
  int late = 0;
  int early = 0;
  int missed = 0;
  int unavoidable = 0;
  int false_count = 0;
  int false_by_lie = 0;
  int urgent = 0;
  int urgent_false = 0;
  int urgent_by_lie = 0;
  int runs_by_lie = 0;       ///< Runs with at least one URGENT caused by a lie.
  int planner_contacts = 0;  ///< Runs in which it still comes to a contact.
  int driver_contacts = 0;
  int planner_needless = 0;  ///< Runs in which braking starts and none was needed ...
  int driver_needless = 0;
  double speed_lost_mps = 0.0;   ///< ... and what the planner's cost, summed.
  std::vector<double> delays_s;  ///< Against truth, of true and late ones.

  void Add(const ConsumerTally& other);
  [[nodiscard]] std::optional<double> delay_p95_s() const;
};

/// The figures of WarnScore as campaigns pool them.
struct WarnTally {
  int runs = 0;
  double seconds = 0.0;
  int contacts_unwarned = 0;  ///< Runs that end in a contact if nobody brakes.
  ConsumerTally v2v;
  ConsumerTally local;
  ConsumerTally ours;

  void Add(const WarnTally& other);
};

/// Reads what WarnScoreJson() wrote: one run.
/// @return false where the text is not such an object.
bool ReadWarnTally(const std::string& text, WarnTally& tally);

}  // namespace v2vouch::evaluation
