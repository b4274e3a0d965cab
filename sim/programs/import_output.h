// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "sim/import/imported_event.h"

namespace v2vouch::sim {

/// Says why on standard error. @return the program's exit code for it.
int ImportFailed(const std::string& why);

/// What the program found, on standard output: one line of JSON, or a line each.
void TellFigures(const nlohmann::ordered_json& figures, bool as_json);

/// Writes the log `out`, which may be none of `inputs`, and tells of it: its name, `figures`, what
/// is in it.
/// @return the program's exit code.
int WriteImportedLog(const std::string& out, std::span<const std::string> inputs,
                     const std::vector<ImportedEvent>& events,
                     const nlohmann::ordered_json& figures, bool as_json);

}  // namespace v2vouch::sim
