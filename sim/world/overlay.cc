// SPDX-License-Identifier: Apache-2.0
#include "sim/world/overlay.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <utility>

#include "daemon/rim/config/yaml_reader.h"

namespace v2vouch::sim {
namespace {

// The file's keys: those of a scenario, read over one, and `suits`.
struct OverlayFile {
  Scenario scenario;
  std::vector<std::string> suits{};

  template <class Archive>
  void Visit(Archive& a) {
    scenario.Visit(a);
    a.Field("suits", suits);
  }
};

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

template <class T>
void PutBefore(const std::vector<T>& earlier, std::vector<T>& later) {
  later.insert(later.begin(), earlier.begin(), earlier.end());
}

bool Read(const std::string& path, OverlayFile& file, Overlay& overlay,
          std::vector<std::string>& problems) {
  file.scenario.name.clear();
  file.scenario.description.clear();
  file.scenario.routes.clear();
  file.scenario.vehicles.clear();
  file.scenario.parked.clear();
  file.scenario.buildings.clear();
  file.scenario.poles.clear();
  file.scenario.pole_rows.clear();
  file.scenario.rails.clear();
  file.scenario.mounting.clear();
  file.scenario.attacks.clear();
  file.scenario.overlays.clear();
  if (!config::Load(path, file, problems)) return false;
  overlay.name = file.scenario.name.empty() ? OverlayName(path) : file.scenario.name;
  overlay.description = file.scenario.description;
  overlay.suits = file.suits;
  const std::size_t before = problems.size();
  for (std::size_t i = 0; i < file.scenario.attacks.size(); ++i) {
    CheckAttack(file.scenario.attacks[i], path + ": attacks[" + std::to_string(i) + "]", problems);
  }
  return problems.size() == before;
}

}  // namespace

std::string OverlayName(const std::string& path) {
  const std::string stem = std::filesystem::path(path).stem().string();
  const bool is_numbered = stem.size() > 4 && (stem[0] == 'A' || stem[0] == 'H') &&
                           IsDigit(stem[1]) && IsDigit(stem[2]) && stem[3] == '_';
  if (!is_numbered) return stem;
  return stem.substr(0, 1) + std::to_string(std::stoi(stem.substr(1, 2))) + "/" + stem.substr(4);
}

bool LayOver(const std::string& path, Scenario& scenario, std::vector<std::string>& problems) {
  OverlayFile file{scenario};
  Overlay overlay;
  if (!Read(path, file, overlay, problems)) return false;
  if (!overlay.suits.empty() &&
      std::find(overlay.suits.begin(), overlay.suits.end(), scenario.name) == overlay.suits.end()) {
    std::string names;
    for (const std::string& name : overlay.suits) names += (names.empty() ? "" : ", ") + name;
    problems.push_back(path + ": does not suit scenario " + scenario.name + ", but " + names);
    return false;
  }
  Scenario& merged = file.scenario;
  merged.name = scenario.name;
  merged.description = scenario.description;
  PutBefore(scenario.routes, merged.routes);
  PutBefore(scenario.vehicles, merged.vehicles);
  PutBefore(scenario.parked, merged.parked);
  PutBefore(scenario.buildings, merged.buildings);
  PutBefore(scenario.poles, merged.poles);
  PutBefore(scenario.pole_rows, merged.pole_rows);
  PutBefore(scenario.rails, merged.rails);
  PutBefore(scenario.mounting, merged.mounting);
  for (AttackSpec& attack : merged.attacks) {
    if (attack.name.empty()) attack.name = overlay.name;
  }
  PutBefore(scenario.attacks, merged.attacks);
  merged.overlays = scenario.overlays;
  merged.overlays.push_back(overlay.name);
  scenario = std::move(merged);
  return true;
}

bool LoadOverlay(const std::string& path, Overlay& overlay, std::vector<std::string>& problems) {
  OverlayFile file;
  return Read(path, file, overlay, problems);
}

}  // namespace v2vouch::sim
