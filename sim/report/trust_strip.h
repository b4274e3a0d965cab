// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {

/// Trust over time, one row per sender, from the V2V list: grey unknown, yellow candidate, green
/// validated, blue bridged, orange suspect, red revoked; a mark where a verdict was given. SVG.
/// @param senders whom to show, the first `at_most` of them; empty: all, those longest heard.
std::string TrustStrips(const RunLog& log, std::vector<std::uint32_t> senders, Timestamp begin,
                        double end_s, std::size_t at_most);

/// Which tracks of a list were held when, one row per id, pale where hidden or out of view. SVG.
std::string TrackStrips(const RunLog& log, ListKind kind, Timestamp begin, double end_s,
                        std::size_t at_most);

}  // namespace v2vouch::evaluation
