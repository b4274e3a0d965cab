// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/spoofing/spoof_run.h"

namespace v2vouch::evaluation {

/// The figures of a run as one JSON object: counts as they are, so that runs can be pooled, and the
/// rates that follow from them. Null where nothing can be measured.
std::string SpoofJson(const SpoofRun& run);

/// Reads what SpoofJson() wrote; what it does not know it passes over.
/// @return false where the text is not such an object.
bool ReadSpoofJson(const std::string& text, SpoofRun& run);

/// The same as a table for the terminal.
std::string SpoofTable(const SpoofRun& run);

}  // namespace v2vouch::evaluation
