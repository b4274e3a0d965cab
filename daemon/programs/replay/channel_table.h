// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "daemon/common/base/reason.h"
#include "daemon/rim/engine/daemon_config.h"

namespace v2vouch {

/// What came on one channel of a log.
struct ChannelFigures {
  bool is_input = false;  ///< The vehicle listens to it.
  std::int64_t received = 0;
  std::int64_t accepted = 0;
  std::map<Reason, std::int64_t> refused;
};

/// Every channel of the vehicle, heard or not, and every other one in the log, by name.
using ChannelTable = std::map<std::string, ChannelFigures>;

/// What is wrong with a run over a log, in sentences for the user, each with what to do about it.
struct LogVerdict {
  std::vector<std::string> problems;  ///< The run came to nothing: exit code 1.
  std::vector<std::string> notes;     ///< It came to something, less than the log could give.
};

/// Problems: no event, no event on a channel of this vehicle, nothing accepted, no ego motion, no
/// list. Notes: channels of the vehicle that are not in the log or refused throughout, channels
/// that look like one of a sensor and belong to none (with the name that was probably meant).
LogVerdict JudgeChannels(const ChannelTable& channels, std::int64_t lists,
                         const DaemonConfig& config);

}  // namespace v2vouch
