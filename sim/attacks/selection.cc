// SPDX-License-Identifier: Apache-2.0
#include "sim/attacks/selection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/attacks/gate.h"
#include "sim/sensors/subject.h"

namespace v2vouch::sim {

bool NeedsViews(const AttackSpec& attack) {
  bool needs = Gate::NeedsViews(attack.when) || attack.who.min_in_view_s > 0.0;
  for (const ChangeSpec& change : attack.change) {
    needs = needs || Gate::NeedsViews(change.when) || change.impersonate;
  }
  const PathSpec& path = attack.path;
  return needs || (path.shadow && path.shadow->vehicle == 0) ||
         (path.grid && path.grid->round == GridSpec::Round::kVehicle);
}

std::vector<std::size_t> ChooseAttackers(const WhoSpec& who, const AttackScene& scene) {
  const auto& actors = scene.world.actors();
  std::vector<std::size_t> chosen;
  if (who.share <= 0.0) {
    for (std::size_t i = 0; i < actors.size(); ++i) {
      const bool is_meant =
          std::find(who.vehicles.begin(), who.vehicles.end(), actors[i].id) != who.vehicles.end();
      if (is_meant && actors[i].has_v2v) chosen.push_back(i);
    }
    return chosen;
  }
  std::vector<std::pair<double, std::size_t>> lots;  // Out of view long enough: behind the others.
  for (std::size_t i = 0; i < actors.size(); ++i) {
    if (!actors[i].has_v2v) continue;
    const double lot = SubjectRandom(scene.seed, "attackers", {actors[i].id}).Uniform();
    const bool is_seen = who.min_in_view_s <= 0.0 || scene.views == nullptr ||
                         scene.views->LongestInView(i) >= who.min_in_view_s;
    lots.emplace_back(is_seen ? lot : lot + 1.0, i);
  }
  std::sort(lots.begin(), lots.end());
  const double exact = who.share * static_cast<double>(lots.size());
  const auto count =
      std::min(lots.size(), static_cast<std::size_t>(std::max(1.0, std::round(exact))));
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(lots[k].second);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::optional<std::size_t> ChooseVictim(const AttackSpec& attack, const AttackScene& scene,
                                        std::vector<std::string>& notes) {
  const PathSpec& path = attack.path;
  const bool surrounds = path.grid && path.grid->round == GridSpec::Round::kVehicle;
  if (!path.shadow && !surrounds) return std::nullopt;
  const auto& actors = scene.world.actors();
  std::optional<std::size_t> best;
  double best_s = 0.0;
  for (std::size_t i = 0; i < actors.size(); ++i) {
    if (path.shadow && path.shadow->vehicle != 0) {
      if (actors[i].id == path.shadow->vehicle) best = i;
      continue;
    }
    if (path.shadow && actors[i].has_v2v != path.shadow->has_v2v) continue;
    if (scene.views == nullptr) continue;
    const bool by_hiding = path.shadow && path.shadow->gets_hidden;
    const double score_s =
        by_hiding ? scene.views->LongestHidden(i) : scene.views->LongestDriving(i);
    if (score_s <= best_s) continue;
    best_s = score_s;
    best = i;
  }
  if (!best) notes.push_back(attack.name + ": no vehicle of the kind it needs in this run");
  return best;
}

}  // namespace v2vouch::sim
