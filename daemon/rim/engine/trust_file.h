// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/v2v/trust/trust_memory.h"

namespace v2vouch {

/// The trust in senders as a file: text, a header line with the version, one line per sender, the
/// SHA-256 of all lines above in the last. Whoever may write it is believed; keep it where only the
/// daemon writes.
struct TrustFile {
  std::string vehicle;  ///< VehicleConfig::id of the car that saved it.
  Timestamp saved{};    ///< By the wall clock.
  std::vector<TrustMemory> senders;
};

inline constexpr std::size_t kMostTrustFileBytes = 128 * 1024;

std::string PrintTrust(const TrustFile& file);

/// Strict: what PrintTrust() would not write is refused. @return nullopt with `problem` set.
std::optional<TrustFile> ParseTrust(std::string_view text, std::string& problem);

struct LoadedTrust {
  std::vector<TrustMemory> senders;  ///< Ages as of `now`.
  std::string problem;               ///< "" = the file was good, or is not there yet.
  bool is_foreign = false;           ///< A file, but none of ours: it must not be overwritten.
};

/// Reads it as of the wall clock's `now`. A file that is damaged, of another version or vehicle, or
/// older than `max_age_s` gives nothing and a problem; so do single senders without a finding in
/// that time. From a file of the future (the clock was set back) penalties are taken as new.
LoadedTrust LoadTrust(const std::string& path, const std::string& vehicle, Timestamp now,
                      double max_age_s);

}  // namespace v2vouch
