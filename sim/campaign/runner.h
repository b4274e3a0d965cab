// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/campaign/children.h"
#include "sim/campaign/record.h"

namespace v2vouch::campaign {

struct RunnerSettings {
  std::filesystem::path programs;      ///< Folder of v2vouch-sim, v2vouch-replay, v2vouch-eval.
  std::filesystem::path folder;        ///< Of the campaign: records go to folder/runs.
  std::filesystem::path scratch;       ///< For logs, which are large: removed once scored.
  std::filesystem::path config;        ///< Vehicle, with `v2v.message_verdicts: true`.
  std::filesystem::path paper_config;  ///< Empty: the paper's method is not run.
  bool with_message_checks = false;
  bool with_warnings = false;  ///< Also the warnings of three consumers.
  bool keeps_logs = false;
  int at_a_time = 1;
};

/// How far a campaign is.
struct Tally {
  std::size_t total = 0;
  std::size_t there_before = 0;  ///< Found done: not run again.
  std::size_t done = 0;          ///< In this call.
  std::size_t failed = 0;
  [[nodiscard]] std::size_t left() const { return total - there_before - done - failed; }
};

/// Those of the three programs that `settings.programs` does not hold or that may not be run.
std::vector<std::string> MissingPrograms(const RunnerSettings& settings);

/// Runs what is not there yet: simulator, core, scoring, each a child process, `at_a_time` runs at
/// once. A run that fails is told to `tell` (which command, what it said) and stops no other.
/// @param tick called about five times a second, from the calling thread; it may stop `children`,
/// whereupon what runs is ended and nothing else begins.
Tally RunAll(const std::vector<Job>& jobs, const RunnerSettings& settings, Children& children,
             const std::function<void(const Tally&)>& tick,
             const std::function<void(const std::string&)>& tell);

/// A vehicle description with `v2v.message_verdicts` on, written to `to`. `from` empty: the shipped
/// vehicle. @return false with `problem` set.
bool WriteConfig(const std::filesystem::path& from, const std::filesystem::path& to,
                 std::string& problem);

}  // namespace v2vouch::campaign
