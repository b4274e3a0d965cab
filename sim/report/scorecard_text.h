// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "sim/scorecard/scorecard.h"

namespace v2vouch::evaluation {

/// The scorecards of LOCAL and PRIORITY as JSON (keys "local" and "priority", units in the keys)
/// and as lines for the terminal.
nlohmann::ordered_json ScorecardJson(const Scorecards& cards);
std::string ScorecardTable(const Scorecards& cards);

/// Only the scorecards, as one JSON object or table with its heading.
std::string ScorecardFileJson(const RunLog& log, const Scorecards& cards);

}  // namespace v2vouch::evaluation
