// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/spoofing/exposure.h"
#include "sim/spoofing/honest_treatment.h"

namespace v2vouch::evaluation {

/// Counts of a yes/no judgement. Precision and recall are nothing where they divide by zero.
struct Confusion {
  std::int64_t true_positive = 0;
  std::int64_t false_positive = 0;
  std::int64_t false_negative = 0;
  std::int64_t true_negative = 0;

  void Count(bool is_false, bool is_positive);
  void Add(const Confusion& other);
  [[nodiscard]] std::optional<double> precision() const;
  [[nodiscard]] std::optional<double> recall() const;
  /// 2 TP / (2 TP + FP + FN); nothing where no message was false.
  [[nodiscard]] std::optional<double> f1() const;
  /// Share of all that was judged rightly, and of the honest that was judged to be false.
  [[nodiscard]] std::optional<double> accuracy() const;
  [[nodiscard]] std::optional<double> false_positive_rate() const;
};

/// How one attacker fared.
struct SourceOutcome {
  std::int64_t device = 0;
  double first_false_s = 0.0;    ///< First false message in joint view, since the run's begin.
  double false_in_view_s = 0.0;  ///< Time in which its claims were false and in joint view.
  /// From then to the moment it was met: a verdict about one of its ids; or, where it was never
  /// relied on, its first positive message; or the first of three positive messages in a row.
  std::optional<double> met_after_s;
  std::optional<double> accused_after_s;  ///< To the first ACCUSE.
  /// One of its false messages, in view or not, was met by a refusal, SUSPECT or REVOKED.
  bool was_detected = false;
};

/// Attackers with less false time in joint view than this are not counted as sources.
inline constexpr double kSourceInView_s = 1.0;

/// Mean GOSPA of a run, c = 10 m, five times a second: PRIORITY and V2V against the vehicles that
/// send BSMs, LOCAL against all. Nothing where the log has no such list.
struct ListGospa {
  std::optional<double> local, v2v, priority;
};

/// All spoof figures of one run; small, so that campaigns keep one per run.
struct SpoofRun {
  std::string scenario;
  double duration_s = 0.0;
  std::int64_t messages = 0;    ///< Of TRUTH_BSM.
  std::int64_t unanswered = 0;  ///< ... without a BSM_VERDICT.
  std::int64_t false_messages = 0;
  std::int64_t contested = 0;  ///< Honest messages under an id that an attacker used too.
  Confusion by_message;        ///< Of JudgedMessage::counts().
  /// Per source: attackers of `attackers`, positive when detected; honest devices with counted
  /// messages, positive when one of these was.
  Confusion by_source;
  std::vector<SourceOutcome> attackers;  ///< With false messages in joint view, by device.
  Exposure exposure;
  HonestTreatment honest;
  ListGospa gospa;
  std::optional<Confusion> checks_by_message;  ///< The same for message-only checks, if asked for.
  std::optional<Confusion> checks_by_source;
};

/// Scores the spoof resistance of a recorded run that holds TRUTH and TRUTH_BSM, read with
/// ReadScope::kSpoof.
SpoofRun JudgeSpoof(const RunLog& log, bool with_message_checks);

}  // namespace v2vouch::evaluation
