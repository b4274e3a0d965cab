// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "sim/campaign/summary.h"

namespace v2vouch::campaign {

/// {"runs", "seconds", "contacts_unwarned", "v2v": {...}, "local": {...}, "ours": {...}}.
nlohmann::ordered_json WarningsJson(const evaluation::WarnTally& tally);
nlohmann::ordered_json GospaJson(const GospaUnderAttack& gospa);
/// What was detected of vehicles that do not exist, per message and per source.
nlohmann::ordered_json PhantomsJson(const Summary& summary);

/// Warnings per attack for the three consumers; empty where no run has them.
std::string WarningsTable(const Summary& summary);
/// GOSPA under attack over that without, and how well attackers are named; empty without attacks.
std::string AgentsTable(const Summary& summary);

}  // namespace v2vouch::campaign
