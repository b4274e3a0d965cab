// SPDX-License-Identifier: Apache-2.0
#include "sim/world/attack_spec.h"

namespace v2vouch::sim {
namespace {

void CheckWhen(const WhenSpec& when, const std::string& where, std::vector<std::string>& problems) {
  if (when.stop_s > 0.0 && when.stop_s <= when.start_s) {
    problems.push_back(where + ".when: stop_s must be above start_s");
  }
  if ((when.active_s > 0.0) != (when.pause_s > 0.0)) {
    problems.push_back(where + ".when: active_s and pause_s go together");
  }
}

// How many of the optional blocks are there.
template <class... T>
int Given(const std::optional<T>&... blocks) {
  return (0 + ... + (blocks.has_value() ? 1 : 0));
}

void CheckRange(double low, double high, const char* names, const std::string& where,
                std::vector<std::string>& problems) {
  if (low > high) problems.push_back(where + ": " + names + ": the first is above the second");
}

void CheckChange(const ChangeSpec& c, const std::string& where,
                 std::vector<std::string>& problems) {
  if (Given(c.offset, c.drift, c.brake, c.freeze, c.eventual_stop, c.speed, c.heading,
            c.acceleration, c.size, c.accuracy, c.mirror, c.rotate, c.delay, c.replay, c.identity,
            c.impersonate, c.rate) != 1) {
    problems.push_back(where + ": must name exactly one block");
  }
  CheckWhen(c.when, where, problems);
  if (c.offset) CheckRange(c.offset->low_m, c.offset->high_m, "low_m, high_m", where, problems);
  if (c.speed)
    CheckRange(c.speed->low_mps, c.speed->high_mps, "low_mps, high_mps", where, problems);
  if (c.acceleration) {
    CheckRange(c.acceleration->low_scale, c.acceleration->high_scale, "low_scale, high_scale",
               where, problems);
  }
  if (c.delay) CheckRange(c.delay->low_s, c.delay->high_s, "low_s, high_s", where, problems);
  if (c.replay) CheckRange(c.replay->low, c.replay->high, "low, high", where, problems);
}

}  // namespace

void CheckAttack(const AttackSpec& attack, const std::string& where,
                 std::vector<std::string>& problems) {
  const WhoSpec& who = attack.who;
  const int ways =
      (who.vehicles.empty() ? 0 : 1) + (who.share > 0.0 ? 1 : 0) + (who.devices > 0 ? 1 : 0);
  if (ways != 1) {
    problems.push_back(where + ".who: must give exactly one of vehicles, share and devices");
  }
  CheckWhen(attack.when, where, problems);
  if (attack.when.after_s > 0.0) {
    problems.push_back(where + ".when: after_s is for blocks; an attack has start_s");
  }
  const PathSpec& path = attack.path;
  bool asks_for_view = attack.when.after_in_view_s > 0.0 || attack.when.after_hidden_s > 0.0;
  for (const ChangeSpec& change : attack.change) {
    asks_for_view =
        asks_for_view || change.when.after_in_view_s > 0.0 || change.when.after_hidden_s > 0.0;
  }
  if (who.devices > 0 && asks_for_view && !path.shadow) {
    problems.push_back(where + ".when: a device speaks for no vehicle that could be in view");
  }
  const int paths = Given(path.ghost, path.shadow, path.grid, path.swap, path.behind, path.flood);
  if (paths > 1) problems.push_back(where + ".path: must name one at most");
  if (who.devices > 0 &&
      (path.swap || (path.grid && path.grid->round == GridSpec::Round::kAttacker))) {
    problems.push_back(where + ".path: needs a vehicle of the attacker's own, not a device");
  }
  if (path.flood && (who.devices == 0 || !attack.change.empty())) {
    problems.push_back(where + ".path.flood: is for devices and takes no `change`");
  }
  if (paths == 0 && attack.change.empty()) {
    problems.push_back(where + ": neither `path` nor `change` says what is false");
  }
  for (std::size_t i = 0; i < attack.change.size(); ++i) {
    CheckChange(attack.change[i], where + ".change[" + std::to_string(i) + "]", problems);
  }
}

}  // namespace v2vouch::sim
