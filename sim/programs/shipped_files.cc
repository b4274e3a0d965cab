// SPDX-License-Identifier: Apache-2.0
#include "sim/programs/shipped_files.h"

#include <algorithm>
#include <cctype>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/rim/program/shipped_folder.h"
#include "sim/world/overlay.h"

namespace v2vouch::sim {
namespace {

std::filesystem::path ScenarioFolder() { return ShippedFolder("scenarios"); }
std::filesystem::path OverlayFolder() { return ShippedFolder("attacks"); }

std::vector<std::filesystem::path> YamlFiles(const std::string& shipped, std::string& problem) {
  const std::filesystem::path folder = ShippedFolder(shipped);
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  if (error) problem = folder.string() + ": " + error.message();
  if (const std::string missing = WhyNotShipped(shipped); !missing.empty()) problem = missing;
  std::sort(files.begin(), files.end());
  return files;
}

std::string Find(const std::string& name, const std::filesystem::path& shipped,
                 const std::string& folder, const char* what, const std::vector<std::string>& known,
                 std::string& problem) {
  std::error_code ignored;
  if (std::filesystem::exists(name, ignored)) return name;
  if (std::filesystem::is_regular_file(shipped, ignored)) return shipped.string();
  if (!problem.empty()) problem += "  and ";
  if (const std::string missing = WhyNotShipped(folder); !missing.empty()) {
    problem += name + ": no such file, and " + missing + "\n";
    return name;
  }
  problem += name + ": no such file, and no shipped " + what + " of this name" +
             DidYouMean(name, known) + "; `v2vouch-sim list` shows them\n";
  return name;
}

// As users name them: "left_turn"; "A5/lateral_8m" and "A05_lateral_8m".
std::vector<std::string> Names(const std::vector<std::filesystem::path>& files, bool are_overlays) {
  std::vector<std::string> names;
  for (const auto& file : files) {
    const std::string stem = file.stem().string();
    if (are_overlays) names.push_back(OverlayName(file.string()));
    names.push_back(stem);
  }
  return names;
}

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

}  // namespace

std::vector<std::filesystem::path> ShippedScenarios(std::string& problem) {
  return YamlFiles("scenarios", problem);
}

std::vector<std::filesystem::path> ShippedOverlays(std::string& problem) {
  return YamlFiles("attacks", problem);
}

std::string FindScenario(const std::string& name, std::string& problem) {
  std::string ignored;
  return Find(name, ScenarioFolder() / (name + ".yaml"), "scenarios", "scenario",
              Names(ShippedScenarios(ignored), false), problem);
}

std::string FindOverlay(const std::string& name, std::string& problem) {
  std::string stem = name;
  const std::size_t slash = name.find('/');
  if (slash != std::string::npos && slash >= 2) {  // "A5/x": files sort by two digits.
    const std::string digits = name.substr(1, slash - 1);
    if (std::all_of(digits.begin(), digits.end(), IsDigit)) {
      stem = name.substr(0, 1) + (digits.size() == 1 ? "0" : "") + digits + "_" +
             name.substr(slash + 1);
    }
  }
  std::string ignored;
  return Find(name, OverlayFolder() / (stem + ".yaml"), "attacks", "overlay",
              Names(ShippedOverlays(ignored), true), problem);
}

}  // namespace v2vouch::sim
