// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/campaign/job.h"
#include "sim/spoofing/spoof_run.h"
#include "sim/warnings/warn_tally.h"

namespace v2vouch::campaign {

/// What is kept of one run: some kilobytes of JSON under DIR/runs/, named by Job::key().
struct RunRecord {
  Job job;
  evaluation::SpoofRun ours;
  std::optional<evaluation::SpoofRun> paper;  ///< The same run by the paper's method.
  /// What the warnings of the run came to, and the JSON of v2vouch-eval it was read from.
  std::optional<evaluation::WarnTally> warnings;
  std::string warnings_json;
  std::string local_digest;  ///< SHA-256 of LOCAL, from the replay.
  double step_p99_us = 0.0;  ///< Of the daemon's core, per input.
  double step_max_us = 0.0;
};

std::filesystem::path RecordPath(const std::filesystem::path& folder, const Job& job);

/// Writes under a temporary name, then renames: a record is whole or absent, and several shards may
/// write into one folder.
/// @return false with `problem` set.
bool WriteRecord(const std::filesystem::path& folder, const RunRecord& record,
                 std::string& problem);

/// Nothing where the file is absent or is no record.
std::optional<RunRecord> ReadRecord(const std::filesystem::path& file);

/// All records of the folders, in order of key; of the same key the first folder's. Files that are
/// no records are named in `problems`.
std::vector<RunRecord> ReadRecords(const std::vector<std::filesystem::path>& folders,
                                   std::vector<std::string>& problems);

}  // namespace v2vouch::campaign
