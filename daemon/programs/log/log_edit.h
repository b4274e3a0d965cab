// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace v2vouch {

/// What is in one log.
struct LogInfo {
  struct Channel {
    std::int64_t messages = 0;
    std::int64_t bytes = 0;
    std::string type;  ///< Of the newest message; "" none of ours.
    std::int64_t first_us = 0;
    std::int64_t last_us = 0;
    double longest_gap_s = 0.0;
  };
  std::map<std::string, Channel> channels;
  std::int64_t events = 0;
  std::int64_t bytes = 0;
  std::int64_t first_us = 0;  ///< Earliest time of recording, whatever the order.
  std::int64_t last_us = 0;
  std::int64_t damaged = 0;     ///< Stretches.
  std::int64_t steps_back = 0;  ///< Events recorded earlier than the one before.
};

/// nullopt with `error` set where the log cannot be read.
std::optional<LogInfo> ReadLogInfo(const std::string& path, std::string& error);

/// Which events are copied.
struct LogFilter {
  std::optional<double> from_s;       ///< After the log's first event.
  std::optional<double> to_s;         ///< The same; not included.
  std::vector<std::string> channels;  ///< Names with * and ?; empty: all.
  std::vector<std::string> without;   ///< The same, left out.
};

/// Whether `name` fits a pattern of letters, * and ?.
bool FitsPattern(const std::string& name, const std::string& pattern);

/// What was written, and what could not be read for it.
struct CopiedLog {
  std::int64_t events = 0;
  std::vector<std::int64_t> damaged;  ///< Stretches of each log that was read, in the order given.
};

/// Copies what fits, bytes and times unchanged. nullopt with `error` set where that fails.
std::optional<CopiedLog> CopyLog(const std::string& in, const std::string& out,
                                 const LogFilter& filter, std::string& error);

/// All events of the logs in the order of their recording; equal times in the order of the files.
/// A log that steps back in time is put in order too, held in memory for that.
std::optional<CopiedLog> MergeLogs(const std::vector<std::string>& in, const std::string& out,
                                   std::string& error);

}  // namespace v2vouch
