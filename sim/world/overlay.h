// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/world/scenario.h"

namespace v2vouch::sim {

/// A YAML file laid over a scenario: an attack, a condition, denser traffic. It has the scenario's
/// own sections and keys, all optional. A key given here replaces the scenario's; the lists
/// `routes`, `vehicles`, `parked`, `buildings`, `poles`, `pole_rows`, `rails`, `mounting` and
/// `attacks` are appended to it. Three keys are its own:
struct Overlay {
  std::string name;         ///< E.g. "A5/lateral_8m"; unless given, made from the file's name.
  std::string description;  ///< One line.
  std::vector<std::string> suits;  ///< Scenarios it makes sense with; empty = all.
};

/// "A5/lateral_8m" of "A05_lateral_8m.yaml"; other files' names without ".yaml".
std::string OverlayName(const std::string& path);

/// Lays the file over `scenario`, which remembers its name in `overlays`. Ids and names are not
/// compared yet: CheckReferences does so once all overlays and settings are in.
/// @return false with problems, each with the file and line, when it is no overlay or does not
/// suit.
bool LayOver(const std::string& path, Scenario& scenario, std::vector<std::string>& problems);

/// Reads and checks an overlay by itself.
bool LoadOverlay(const std::string& path, Overlay& overlay, std::vector<std::string>& problems);

}  // namespace v2vouch::sim
