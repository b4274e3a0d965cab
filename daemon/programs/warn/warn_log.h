// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "daemon/programs/warn/warn_config.h"

namespace v2vouch {

/// One warning from its beginning to its end.
struct WarnEpisode {
  warnings::Warning worst;  ///< As it stood at its highest level (LOST counts lowest).
  Timestamp until{};
  std::int64_t seen_in = 0;  ///< Number of the last list that held it.
};

struct WarnResult {
  std::int64_t events = 0;
  std::int64_t taken = 0;    ///< Messages on the four channels.
  std::int64_t refused = 0;  ///< Of these, not decoded.
  std::int64_t lists = 0;    ///< Warning lists made.
  std::int64_t old_outputs = 0;
  std::int64_t damaged = 0;
  std::int32_t degraded = 0;  ///< Bits that every list had.
  Timestamp first{};          ///< Recording of the log's first event.
  double log_seconds = 0.0;
  std::vector<double> step_us;
  std::vector<WarnEpisode> episodes;
};

/// Collects episodes from list to list.
void NoteEpisodes(const warnings::WarningList& list, WarnResult& result);

/// Feeds the log at `in` to the warner, writes all of its events with the warnings right behind the
/// event that caused them to `out` (empty: nothing). Warnings recorded earlier are dropped.
bool WarnOverLog(const std::string& in, const std::string& out, const WarnFile& file,
                 const std::function<bool(double)>& progress, WarnResult& result,
                 std::string& error);

std::string WarnJson(const WarnResult& result);
std::string WarnText(const WarnResult& result);
/// One line about one warning, with the figures it rests on.
std::string WarningLine(const warnings::Warning& warning);

}  // namespace v2vouch
