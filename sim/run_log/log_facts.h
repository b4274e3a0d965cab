// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/common/base/time.h"

namespace v2vouch::evaluation {

/// What a log holds whatever it is of: messages per channel and second, and what the daemon
/// refused.
struct LogFacts {
  struct Channel {
    std::string name;
    std::int64_t messages = 0;
    std::vector<int> per_second;  ///< From `begin` on.
  };
  struct Refusal {
    std::string channel, reason, field;
    std::int64_t count = 0;
  };
  Timestamp begin{};
  std::vector<Channel> channels;  ///< By name; at most 256.
  std::vector<Refusal> refusals;  ///< Of the last V2VOUCH_STATUS, the most first.
  bool has_status = false;
};

/// @return false with `error` set where the file cannot be read.
bool ReadLogFacts(const std::string& path, LogFacts& facts, std::string& error);

}  // namespace v2vouch::evaluation
