// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daemon/programs/warn/warn_config.h"

namespace v2vouch {

/// Listens and publishes until a stop is asked for. Where no list comes for 0.3 s, an empty one
/// that says so goes out every 0.1 s. @param is_told prints a line when a warning rises.
/// @return the exit code.
int WarnLive(const std::string& lcm_url, const WarnFile& file, bool is_told);

}  // namespace v2vouch
