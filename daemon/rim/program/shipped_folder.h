// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace v2vouch {

/// The folder of files that come with the programs: "scenarios", "attacks", "config" (vehicle
/// files) or "lcmtypes". $V2VOUCH_SHARE/NAME where that variable is set and not empty, else
/// ../share/v2vouch/NAME as seen from the program's own folder: after `cmake --install` below the
/// prefix, and in a build tree below build/PRESET, where links lead to the sources. No program
/// knows the path of a source tree.
/// @return a path that may not exist, as after a program was copied alone: WhyNotShipped tells.
std::filesystem::path ShippedFolder(const std::string& name);

/// "" where that folder is; else where it was looked for, and what to do.
std::string WhyNotShipped(const std::string& name);

}  // namespace v2vouch
