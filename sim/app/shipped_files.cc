// SPDX-License-Identifier: Apache-2.0
#include "sim/app/shipped_files.h"

#include <algorithm>
#include <cctype>

namespace v2vouch::sim {
namespace {

std::filesystem::path Folder(const char* installed_as, const char* in_source_tree) {
  std::error_code ignored;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const auto installed = self.parent_path().parent_path() / "share/v2vouch" / installed_as;
  if (std::filesystem::is_directory(installed, ignored)) return installed;
  return in_source_tree;
}

std::filesystem::path ScenarioFolder() { return Folder("scenarios", V2VOUCH_SCENARIO_DIR); }
std::filesystem::path OverlayFolder() { return Folder("catalogue", V2VOUCH_CATALOGUE_DIR); }

std::vector<std::filesystem::path> YamlFiles(const std::filesystem::path& folder,
                                             std::string& problem) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  if (error) problem = folder.string() + ": " + error.message();
  std::sort(files.begin(), files.end());
  return files;
}

std::string Find(const std::string& name, const std::filesystem::path& shipped) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(name, ignored)) return name;
  return std::filesystem::is_regular_file(shipped, ignored) ? shipped.string() : name;
}

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

}  // namespace

std::vector<std::filesystem::path> ShippedScenarios(std::string& problem) {
  return YamlFiles(ScenarioFolder(), problem);
}

std::vector<std::filesystem::path> ShippedOverlays(std::string& problem) {
  return YamlFiles(OverlayFolder(), problem);
}

std::string FindScenario(const std::string& name) {
  return Find(name, ScenarioFolder() / (name + ".yaml"));
}

std::string FindOverlay(const std::string& name) {
  std::string stem = name;
  const std::size_t slash = name.find('/');
  if (slash != std::string::npos && slash >= 2) {  // "A5/x": files sort by two digits.
    const std::string digits = name.substr(1, slash - 1);
    if (std::all_of(digits.begin(), digits.end(), IsDigit)) {
      stem = name.substr(0, 1) + (digits.size() == 1 ? "0" : "") + digits + "_" +
             name.substr(slash + 1);
    }
  }
  return Find(name, OverlayFolder() / (stem + ".yaml"));
}

}  // namespace v2vouch::sim
