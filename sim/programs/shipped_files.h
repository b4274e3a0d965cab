// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace v2vouch::sim {

/// The YAML files that come with the simulator, in folders `scenarios` and `attacks` of
/// ShippedFolder(). Ordered by name; empty with `problem` set when the folder cannot be read.
std::vector<std::filesystem::path> ShippedScenarios(std::string& problem);
std::vector<std::filesystem::path> ShippedOverlays(std::string& problem);

/// The file meant by the name of a shipped scenario or by a path. Where there is none: `name`
/// itself, and one more line in `problem` that names what was probably meant.
std::string FindScenario(const std::string& name, std::string& problem);

/// The same for overlays: a path, "A05_lateral_8m", or "A5/lateral_8m".
std::string FindOverlay(const std::string& name, std::string& problem);

}  // namespace v2vouch::sim
