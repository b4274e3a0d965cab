// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

namespace v2vouch {

struct CsvTable {
  std::int64_t rows = 0;        ///< Fewer than there are where `out` takes no more (std::ferror).
  std::int64_t unreadable = 0;  ///< Messages of the channel, damaged or of another type.
  std::int64_t damaged = 0;     ///< Stretches of the log.
};

/// One row per message of a channel, or, where fields of one list are asked for, one per element.
/// Fields by their names in the .lcm file: "speed_mps", "tracks.x_body_m", "covariance_body[7]",
/// "inputs.channel". Columns: recorded_utime, then the fields as given; strings are quoted where
/// CSV wants it, numbers exact, NaN as nan.
/// @param fields empty: all of the type that are no list.
/// @return nullopt with `error` (an unknown field with the one that was probably meant).
std::optional<CsvTable> WriteCsv(const std::string& log, const std::string& channel,
                                 std::vector<std::string> fields, std::FILE* out,
                                 std::string& error);

}  // namespace v2vouch
