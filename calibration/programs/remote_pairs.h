// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "daemon/rim/engine/daemon_config.h"
#include "daemon/v2v/gps_bias/remote_solution.h"

namespace v2vouch {

/// Runs logs through the perception core as configured and collects what its sensors confirmed of
/// senders: a pair exists only while radar and camera vouch for the vehicle and its sender is
/// relied on, so a claim never takes part in confirming itself.
/// @param progress share of all bytes read.
bool CollectRemotePairs(const std::vector<std::string>& logs, const DaemonConfig& config,
                        std::vector<RemotePair>& pairs, std::string& error,
                        const std::function<void(double)>& progress);

}  // namespace v2vouch
