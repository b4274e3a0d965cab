// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {

/// One sentence for people about RunLog::other_types, and what to do.
std::string OtherTypesText(const std::map<std::string, std::int64_t>& other_types);

/// Why this run cannot be judged against its truth, with what to do about it; "" where it can:
/// TRUTH and lists are there, overlap in time, and TRUTH's time runs on without a step (the grid
/// that the run is judged on has an instant for every 50 ms of it).
std::string WhyNotJudged(const RunLog& log);

}  // namespace v2vouch::evaluation
