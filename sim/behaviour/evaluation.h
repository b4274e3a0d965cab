// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/behaviour/behaviour.h"
#include "sim/behaviour/misses.h"
#include "sim/metrics/scoring.h"
#include "sim/scorecard/scorecard.h"

namespace v2vouch::evaluation {

/// One of the three figures that count by themselves (unavoidable misses dominate GOSPA).
struct Gate {
  std::string name;
  double value = kNoValue;
  double limit = 0.0;
  bool may_be_none = false;  ///< Passes without a value: there was nothing to measure.
  [[nodiscard]] bool has_value() const { return value == value; }
  [[nodiscard]] bool passes() const { return has_value() ? value <= limit : may_be_none; }
};

/// Errors of vehicles that PRIORITY kept while no sensor saw them.
struct UnseenError {
  double rms_m = kNoValue;
  double max_m = kNoValue;
  double seconds = 0.0;           ///< Vehicle-seconds unseen and kept.
  double possible_seconds = 0.0;  ///< ... that the bound could keep.
};

/// All figures of one run at one cutoff.
struct CutoffScores {
  double cutoff_m = 10.0;
  std::vector<ListScore> own;  ///< By ListKind; each list against its own scope.
  std::vector<ListScore> all;  ///< By ListKind; each against all vehicles.
};

struct Evaluation {
  RunLog log;
  ScoringSettings settings;
  std::vector<Timestamp> grid;
  std::unique_ptr<Bound> bound;
  double duration_s = 0.0;            ///< First to last truth sample.
  std::vector<CutoffScores> cutoffs;  ///< The headline first, then 10 and 30 where they differ.
  UnseenError hidden;                 ///< Behind something.
  UnseenError out_of_view;            ///< Where no sensor looks.
  Behaviour behaviour;
  Scorecards scorecards;
  std::vector<Miss> misses;               ///< Of PRIORITY, while the bound holds the vehicle.
  double validated_share = 0.0;           ///< Of the time PRIORITY could hold honest V2V cars.
  std::map<std::int64_t, double> hold_s;  ///< Per V2V vehicle: seconds in PRIORITY.
  std::vector<Gate> gates;

  [[nodiscard]] const ListScore& headline(ListKind kind) const {
    return cutoffs.front().own[Index(kind)];
  }
  [[nodiscard]] const CutoffScores& at_cutoff(double cutoff_m) const;
};

/// Scores a run that has truth (`log.truth` is not empty).
std::unique_ptr<Evaluation> Evaluate(RunLog log, const ScoringSettings& settings);

/// The figures as one JSON object. Lengths in metres (keys ending in `_mean` too), times in
/// seconds; `lists` is at the headline cutoff, each list against its own scope. `paper` may be
/// null.
std::string ToJson(const Evaluation& evaluation, const Evaluation* paper);

/// The figures as a table for the terminal.
std::string ToTable(const Evaluation& evaluation, const Evaluation* paper);

/// What can be said of a run without truth: counts and lengths of the lists.
std::string ListSummary(const RunLog& log);
std::string ListSummaryJson(const RunLog& log);

}  // namespace v2vouch::evaluation
