// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "sim/warnings/outcome.h"
#include "sim/warnings/warn_log_reader.h"

namespace v2vouch::evaluation {

/// Episodes at WARN or above of one consumer and kind against those of the engine on truth.
struct WarnCounts {
  int true_count = 0;  ///< Not later than 0.3 s after truth.
  int late = 0;        ///< Later.
  int missed = 0;      ///< Truth only, of a vehicle that had been in sight.
  /// Missed or late, of a vehicle that no list could hold by then: not in sight, nor long enough
  /// before to be vouched for.
  int unavoidable = 0;
  int early = 0;                ///< Ours only, where truth advises.
  int false_count = 0;          ///< Ours only.
  int urgent = 0;               ///< Episodes that reached URGENT.
  int urgent_false = 0;         ///< Of these, truth says nothing from WARN on.
  int urgent_false_unseen = 0;  ///< Of these, of vehicles that are in PRIORITY alone.
  /// Ours only, of a vehicle whose track a liar's messages feed, where LOCAL alone does not say the
  /// same: caused by a lie. Of all and of those that reached URGENT.
  int false_by_lie = 0;
  int urgent_by_lie = 0;
  std::vector<double> delays_s;  ///< Of true and late ones.
};

struct ConsumerScore {
  std::map<warnings::Kind, WarnCounts> kinds;
  Outcome planner;  ///< Brakes at the first URGENT of FCW, IMA or LTA.
  Outcome driver;   ///< At the first WARN.
  bool planner_brakes = false;
  bool driver_brakes = false;
  double first_urgent_s = kNaN;  ///< Since the start of TRUTH.
  double first_warn_s = kNaN;
  double lta_hidden_s = 0.0;       ///< Time in which truth has an LTA of a hidden vehicle ...
  double lta_hidden_held_s = 0.0;  ///< ... and this consumer has one of it too, LOST not counted.
};

struct WarnScore {
  std::string scenario;
  double seconds = 0.0;
  Outcome unwarned;  ///< What happens if nobody brakes.
  double truth_first_urgent_s = kNaN;
  double truth_first_warn_s = kNaN;
  std::array<ConsumerScore, 3> consumers;
};

WarnScore JudgeWarnings(const WarnRun& run);

std::string WarnScoreJson(const WarnScore& score);
std::string WarnScoreTable(const WarnScore& score);

}  // namespace v2vouch::evaluation
