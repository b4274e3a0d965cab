// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "daemon/common/base/reason.h"
#include "daemon/programs/replay/channel_table.h"
#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/engine/refusal_table.h"
#include "daemon/rim/wire/status.h"

namespace v2vouch {

/// What a replay came to.
/// A notice that was in force at some time of the log.
struct ReplayedNotice {
  wire::NoticeStatus notice;  ///< With its value when it began.
  std::int64_t times = 1;     ///< How often it began.
};

struct ReplayResult {
  std::int64_t events = 0;  ///< Read from the log.
  std::int64_t inputs = 0;  ///< Of these, on channels of the vehicle.
  std::int64_t accepted = 0;
  std::int64_t copied = 0;  ///< Of channels that are none of ours (TRUTH, ...), passed through.
  std::int64_t old_outputs = 0;  ///< Recorded earlier by a daemon; left out.
  /// Of cameras with `source: image` or `detected`: pictures for which the log holds nothing on
  /// CAMERA_<NAME>_DETECTED. v2vouch-detect --log adds it.
  std::int64_t unseen_pictures = 0;
  std::int64_t damaged = 0;  ///< Damaged stretches of the log, skipped.
  std::int64_t lists = 0;    ///< LOCAL lists published.
  double log_seconds = 0.0;  ///< First to last event.
  double wall_seconds = 0.0;
  std::vector<double> step_us;  ///< Wall time of each input, decode to encode.
  ReasonCounts refused{};
  std::vector<ReplayedNotice> notices;  ///< In order of their first beginning.
  ChannelTable channels;
  LogVerdict verdict;
  std::vector<RefusalTable::Row> refusal_details;  ///< By channel, reason and field.
  std::string digest_local;
  std::string digest_priority;

  /// Log seconds per wall second, reading and writing included.
  [[nodiscard]] double realtime_factor() const {
    return wall_seconds > 0.0 ? log_seconds / wall_seconds : 0.0;
  }
};

/// Feeds the log at `in` to the core and writes all of its events with the outputs to `out` (empty:
/// nothing is written). An output carries the log time of the event that caused it and stands right
/// behind it. Recorded outputs of an earlier run are dropped and counted; every other channel goes
/// through untouched. No network runs: a camera with `source: image` is taken as `detected`, so the
/// boxes that were recorded with its pictures are the input.
/// @param progress called before every event, a step of which may take milliseconds, with the share
/// done, 0..1; returning false stops the run.
/// @return false with `error` set when a file cannot be read or written, or when stopped.
bool Replay(const std::string& in, const std::string& out, const DaemonConfig& config,
            const std::function<bool(double)>& progress, ReplayResult& result, std::string& error);

/// {"events":..,"log_seconds":..,"wall_seconds":..,"realtime_factor":..,
///  "step_us":{"p50":..,"p99":..,"max":..},"refused":{"REASON":n,...},
///  "notices":[{"name":..,"channel":..,"value":..,"since_utime":..,"times":..},...],
///  "refusal_details":[{"channel":"..","reason":"..","field":"..","count":n},...],
///  "digest_local":"...","digest_priority":"...", and the other counts}
std::string JsonReport(const ReplayResult& result);

/// The same for people.
std::string TextReport(const ReplayResult& result);

}  // namespace v2vouch
