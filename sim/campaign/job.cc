// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/job.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <tuple>
#include <utility>

#include "daemon/common/base/did_you_mean.h"

namespace v2vouch::campaign {
namespace {

struct CatalogueName {
  char letter = 'A';
  int number = 0;
  std::string variant;
};

// "A05_lateral_8m" -> A, 5, "lateral_8m".
std::optional<CatalogueName> ParseName(std::string_view stem) {
  if (stem.size() < 2 || (stem[0] != 'A' && stem[0] != 'H')) return std::nullopt;
  CatalogueName name;
  name.letter = stem[0];
  std::size_t i = 1;
  for (; i < stem.size() && std::isdigit(static_cast<unsigned char>(stem[i])) != 0; ++i) {
    if (i > 4) return std::nullopt;
    name.number = 10 * name.number + (stem[i] - '0');
  }
  if (i == 1 || name.number == 0) return std::nullopt;
  if (i == stem.size()) return name;
  if ((stem[i] != '_' && stem[i] != '/') || i + 1 == stem.size()) return std::nullopt;
  name.variant = stem.substr(i + 1);
  return name;
}

bool IsYamlPath(std::string_view item) { return item.ends_with(".yaml") || item.ends_with(".yml"); }

// A file that is no YAML is the simulator's to refuse.
bool SetsDensity(const std::string& file) {
  try {
    const YAML::Node root = YAML::LoadFile(file);
    return root.IsMap() && root["traffic"] && root["traffic"].IsMap() &&
           root["traffic"]["vehicles"];
  } catch (const YAML::Exception&) {
    return false;
  }
}

// The scenarios that a file says it is for.
std::vector<std::string> Suits(const std::string& file) {
  try {
    const YAML::Node root = YAML::LoadFile(file);
    if (root.IsMap() && root["suits"]) return root["suits"].as<std::vector<std::string>>();
  } catch (const YAML::Exception&) {  // Likewise.
  }
  return {};
}

bool AreSuited(const Overlay& overlay, const Job& job) {
  return overlay.suits.empty() || std::find(overlay.suits.begin(), overlay.suits.end(),
                                            job.scenario_name()) != overlay.suits.end();
}

// What to say of a name that is not in the catalogue, or in it as the other kind.
std::string Unknown(const std::string& item, Kind kind, const std::vector<Overlay>& catalogue) {
  std::vector<std::string> names = {"all", "none"}, variants;
  for (const Overlay& overlay : catalogue) {
    const bool is_it = item == overlay.id || item == overlay.name();
    if (is_it && overlay.kind != kind) {
      return kind == Kind::kAttack ? ": is an honest condition: --honest " + item
                                   : ": is an attack: --attacks " + item;
    }
    if (overlay.kind != kind) continue;
    names.push_back(overlay.id);
    if (item.starts_with(overlay.id + "/")) variants.push_back(overlay.name());
    names.push_back(overlay.name());
  }
  std::string hint = DidYouMean(item, names);
  if (hint.empty() && !variants.empty()) hint = " (there are " + Listed(variants) + ")";
  return std::string(": no such ") + (kind == Kind::kAttack ? "attack" : "honest condition") +
         " in the catalogue" + hint + "; `v2vouch-sim list` shows them";
}

std::string KeyPart(std::string_view text) {
  std::string part;
  for (const char c : text) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    part += is_plain ? c : '-';
  }
  return part;
}

std::vector<std::string> Items(std::string_view list) {
  std::vector<std::string> items;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    if (comma > 0) items.emplace_back(list.substr(0, comma));
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return items;
}

}  // namespace

std::string Job::scenario_name() const { return std::filesystem::path(scenario).stem().string(); }

std::string Job::key() const {
  return KeyPart(overlay.file.empty() ? "plain" : overlay.name()) + "." + KeyPart(scenario_name()) +
         ".d" + std::to_string(density) + ".s" + std::to_string(seed);
}

std::vector<Overlay> ReadCatalogue(const std::vector<std::filesystem::path>& files) {
  std::vector<std::tuple<char, int, std::string, Overlay>> named;
  for (const auto& file : files) {
    const auto name = ParseName(file.stem().string());
    if (!name || file.stem().string().find('/') != std::string::npos) continue;
    Overlay overlay;
    overlay.kind = name->letter == 'A' ? Kind::kAttack : Kind::kHonest;
    overlay.id = name->letter + std::to_string(name->number);
    overlay.variant = name->variant;
    overlay.file = file.string();
    overlay.sets_density = SetsDensity(overlay.file);
    overlay.suits = Suits(overlay.file);
    named.emplace_back(name->letter, name->number, name->variant, std::move(overlay));
  }
  std::sort(named.begin(), named.end(), [](const auto& a, const auto& b) {
    return std::tie(std::get<0>(a), std::get<1>(a), std::get<2>(a)) <
           std::tie(std::get<0>(b), std::get<1>(b), std::get<2>(b));
  });
  std::vector<Overlay> catalogue;
  for (auto& entry : named) catalogue.push_back(std::move(std::get<3>(entry)));
  return catalogue;
}

std::vector<Overlay> Select(std::string_view list, Kind kind, const std::vector<Overlay>& catalogue,
                            std::vector<std::string>& problems) {
  std::vector<Overlay> chosen;
  const auto add = [&](const Overlay& overlay) {
    if (std::find(chosen.begin(), chosen.end(), overlay) == chosen.end()) chosen.push_back(overlay);
  };
  for (const std::string& item : Items(list)) {
    if (item == "none") continue;
    if (IsYamlPath(item)) {
      if (!std::filesystem::is_regular_file(item)) {
        problems.push_back(item + ": no such file");
      } else {
        add({kind, std::filesystem::path(item).stem().string(), "", item, SetsDensity(item),
             Suits(item)});
      }
      continue;
    }
    const auto name = ParseName(item);
    bool is_known = false;
    for (const Overlay& overlay : catalogue) {
      const bool is_meant =
          item == "all" || (name && overlay.id == name->letter + std::to_string(name->number) &&
                            (name->variant.empty() || overlay.variant == name->variant));
      if (overlay.kind != kind || !is_meant) continue;
      is_known = true;
      add(overlay);
    }
    if (!is_known) problems.push_back(item + Unknown(item, kind, catalogue));
  }
  return chosen;
}

std::vector<Job> Jobs(const Plan& plan) {
  std::vector<Overlay> overlays = plan.overlays;
  const bool has_attack = std::any_of(overlays.begin(), overlays.end(), [](const Overlay& overlay) {
    return overlay.kind == Kind::kAttack;
  });
  if (plan.with_plain && (overlays.empty() || has_attack))
    overlays.insert(overlays.begin(), Overlay{});
  std::vector<Job> jobs;
  for (int i = 0; i < plan.seeds; ++i) {
    for (const std::string& scenario : plan.scenarios) {
      for (const int density : plan.densities) {
        for (const Overlay& overlay : overlays) {
          if (overlay.sets_density && density != plan.densities.front()) continue;
          Job job{overlay, scenario, overlay.sets_density ? 0 : density,
                  plan.first_seed + static_cast<std::uint64_t>(i)};
          if (AreSuited(overlay, job)) jobs.push_back(std::move(job));
        }
      }
    }
  }
  return jobs;
}

std::vector<Job> Shard(const std::vector<Job>& jobs, std::size_t i, std::size_t n) {
  std::vector<Job> mine;
  for (std::size_t k = i - 1; k < jobs.size(); k += n) mine.push_back(jobs[k]);
  return mine;
}

}  // namespace v2vouch::campaign
