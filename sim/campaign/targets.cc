// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/targets.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

#include "sim/plot/svg.h"

namespace v2vouch::campaign {
namespace {

using evaluation::AttackFigures;

// `*` stands for anything.
bool Matches(std::string_view text, std::string_view pattern) {
  if (pattern.empty()) return text.empty();
  if (pattern.front() != '*') {
    return !text.empty() && text.front() == pattern.front() &&
           Matches(text.substr(1), pattern.substr(1));
  }
  for (std::size_t skip = 0; skip <= text.size(); ++skip) {
    if (Matches(text.substr(skip), pattern.substr(1))) return true;
  }
  return false;
}

/// The groups a target covers: each named variant by itself, and ids that have no variants.
std::vector<const Group*> Covered(const std::vector<Group>& groups,
                                  const std::vector<std::string_view>& patterns) {
  std::vector<const Group*> covered;
  const auto add = [&](const Group& group) {
    const std::string name = group.name();
    if (std::any_of(patterns.begin(), patterns.end(),
                    [&](std::string_view pattern) { return Matches(name, pattern); })) {
      covered.push_back(&group);
    }
  };
  for (const Group& group : groups) {
    if (group.variants.empty()) add(group);
    for (const Group& variant : group.variants) add(variant);
  }
  return covered;
}

/// One reading of a group.
struct Reading {
  std::optional<double> value;
  bool is_censored = false;
};

class Judge {
 public:
  explicit Judge(const Summary& summary) : summary_(summary) {}

  void Attacks(const std::string& what, const std::vector<std::string_view>& patterns,
               bool is_at_least, double limit, int digits,
               const std::function<Reading(const Group&)>& read) {
    Add(what, Covered(summary_.attacks, patterns), is_at_least, limit, digits, read);
  }
  void Honest(const std::string& what, const std::vector<std::string_view>& patterns,
              bool is_at_least, double limit, int digits,
              const std::function<Reading(const Group&)>& read) {
    Add(what, Covered(summary_.honest, patterns), is_at_least, limit, digits, read);
  }
  void Add(const std::string& what, const std::vector<const Group*>& groups, bool is_at_least,
           double limit, int digits, const std::function<Reading(const Group&)>& read) {
    if (groups.empty()) return;
    Target target{what, is_at_least, limit, std::nullopt, false, "", digits};
    for (const Group* group : groups) {
      const Reading reading = read(*group);
      if (target.is_censored || (!reading.value && !reading.is_censored)) continue;
      const bool is_worse =
          reading.is_censored || !target.value ||
          (is_at_least ? *reading.value < *target.value : *reading.value > *target.value);
      if (!is_worse) continue;
      target.value = reading.value;
      target.is_censored = reading.is_censored;
      target.worst = group->name();
    }
    targets_.push_back(std::move(target));
  }

  std::vector<Target> Finish() { return std::move(targets_); }

 private:
  const Summary& summary_;
  std::vector<Target> targets_;
};

Reading Time(const AttackFigures& figures, double share) {
  const auto time = figures.met_after.Percentile(share);
  return {time, figures.met_after.count() > 0 && !time};
}

Reading F1(const Group& group) { return {group.attack.by_message.f1, false}; }
Reading SourceF1(const Group& group) { return {group.attack.by_source.f1, false}; }
Reading MetP95(const Group& group) { return Time(group.attack, 0.95); }
Reading MetP50(const Group& group) { return Time(group.attack, 0.5); }
Reading Exposed(const Group& group) { return {group.attack.exposure_max_m, false}; }

Reading Share(double part, double whole) {
  return {whole > 0.0 ? std::optional(part / whole) : std::nullopt, false};
}
Reading AccusationsPerHour(const Group& group) {
  const auto& honest = group.attack.honest;
  return Share(honest.accusations, honest.vehicle_s / 3600.0);
}
Reading Validated(const Group& group) {
  return Share(group.attack.honest.validated, group.attack.honest.in_view);
}
Reading Survival(const Group& group) {
  return Share(group.attack.honest.bridges_survived, group.attack.honest.bridges);
}

const std::vector<std::string_view> kFarOffsets = {"A5/offset_20_70m", "A5/veremi*"};
const std::vector<std::string_view> kFarTeleports = {"A8/jump_10m", "A8/jump_30m", "A8/jump_100m"};
const std::vector<std::string_view> kHalfMetreDrift = {"A7/*_0.5mps"};

void JudgeAttacks(Judge& judge) {
  judge.Attacks("ghost publications by attackers, A1-A4",
                {"A1", "A1/*", "A2", "A2/*", "A3", "A3/*", "A4", "A4/*"}, false, 0, 0,
                [](const Group& g) {
                  return Reading{1.0 * g.attack.ghosts_of_attackers, false};
                });
  judge.Attacks(
      "instants with a car listed twice or more tracks than cars, A11, A12",
      {"A11", "A11/*", "A12", "A12/*"}, false, 0, 0, [](const Group& g) {
        return Reading{static_cast<double>(g.attack.doubled + g.attack.outnumbered), false};
      });
  constexpr double kF1 = 0.98;
  judge.Attacks("F1, A5 offset >= 20 m", kFarOffsets, true, kF1, 3, F1);
  judge.Attacks("F1, A6 random offset", {"A6", "A6/*"}, true, kF1, 3, F1);
  judge.Attacks("F1, A8 teleport >= 10 m", kFarTeleports, true, kF1, 3, F1);
  judge.Attacks("F1 per source, A9 replay", {"A9", "A9/*"}, true, kF1, 3, SourceF1);
  judge.Attacks("F1, A10 delay 2-4 s", {"A10/delay_2_4s*", "A10/stale_60"}, true, kF1, 3, F1);
  judge.Attacks("F1, A11 Sybil", {"A11", "A11/*"}, true, kF1, 3, F1);
  judge.Attacks("F1, A12 Sybil on one car", {"A12", "A12/*"}, true, kF1, 3, F1);
  judge.Attacks("F1, A16 frozen, sudden stop", {"A16", "A16/*"}, true, kF1, 3, F1);
  judge.Attacks("F1, A17 zero speed", {"A17/zero"}, true, kF1, 3, F1);
  judge.Attacks("F1, A17 speed offset >= 2 m/s", {"A17/add_2_7mps"}, true, 0.95, 3, F1);
  judge.Attacks("F1, A18 heading reversed", {"A18/180deg"}, true, kF1, 3, F1);
  constexpr double kFast_s = 1.5;
  judge.Attacks("met p95 [s], A5 offset >= 20 m", kFarOffsets, false, kFast_s, 2, MetP95);
  judge.Attacks("met p95 [s], A6", {"A6", "A6/*"}, false, kFast_s, 2, MetP95);
  judge.Attacks("met p95 [s], A8 teleport >= 10 m", kFarTeleports, false, kFast_s, 2, MetP95);
  judge.Attacks("met p95 [s], A16", {"A16", "A16/*"}, false, kFast_s, 2, MetP95);
  judge.Attacks("met p95 [s], A18 reversed", {"A18/180deg"}, false, kFast_s, 2, MetP95);
  judge.Attacks("met median [s], A7 drift 0.5 m/s", kHalfMetreDrift, false, 7.0, 2, MetP50);
  judge.Attacks("exposure [m], A7 drift 0.5 m/s", kHalfMetreDrift, false, 4.0, 2, Exposed);
  judge.Attacks("exposure [m], A13 walk-off in view", {"A13", "A13/*"}, false, 4.0, 2, Exposed);
  judge.Attacks("exposure [m], A14 walk-off hidden", {"A14", "A14/*"}, false, 8.0, 2, Exposed);
  judge.Attacks("published beside every car in clear view [s], A14", {"A14", "A14/*"}, false, 1.0,
                2, [](const Group& g) {
                  return Reading{g.attack.lingered_max_s, false};
                });
  judge.Attacks("attackers accused, A28 stealth bias", {"A28", "A28/*"}, false, 0, 0,
                [](const Group& g) {
                  return Reading{1.0 * g.attack.accused, false};
                });
  judge.Attacks("honest validated share of that without attack, A22", {"A22", "A22/*"}, true, 0.95,
                3, [](const Group& g) {
                  return Reading{g.validated_ratio, false};
                });
  judge.Attacks("largest step of the core [ms] (sensor frame: 50 ms), A22", {"A22", "A22/*"}, false,
                50.0, 1, [](const Group& g) {
                  return Reading{1e-3 * g.step_max_us, false};
                });
  judge.Attacks("URGENT caused by a lie, ours", {"*"}, false, 0, 0, [](const Group& g) {
    if (!g.warnings) return Reading{};
    return Reading{1.0 * g.warnings->ours.urgent_by_lie, false};
  });
  judge.Attacks("runs whose LOCAL digest an attack changed", {"*"}, false, 0, 0,
                [](const Group& g) {
                  if (g.digests_compared == 0) return Reading{};
                  return Reading{1.0 * g.digests_changed, false};
                });
}

}  // namespace

std::string Target::LimitText() const {
  return (is_at_least ? ">= " : "<= ") + evaluation::Number(limit, 3);
}

std::string Target::ValueText() const {
  if (is_censored) return "never (" + worst + ")";
  if (!value) return "none";
  return evaluation::Fixed(*value, digits) + (worst.empty() ? "" : " (" + worst + ")");
}

std::vector<Target> JudgeTargets(const Summary& summary) {
  Judge judge(summary);
  JudgeAttacks(judge);
  Group all;
  all.id = "all conditions";
  all.attack.honest = summary.all_honest;
  if (!summary.honest.empty() || summary.plain) {
    judge.Add("accusations per honest vehicle-hour", {&all}, false, 0.1, 3, AccusationsPerHour);
  }
  Group plain;
  if (summary.plain) {
    plain = *summary.plain;
    plain.id = "no overlay";
    judge.Add("ghosts by honest senders, without attack", {&plain}, false, 0, 0,
              [](const Group& g) {
                return Reading{1.0 * g.attack.ghosts, false};
              });
  }
  judge.Honest("accusations per vehicle-hour, H3", {"H3", "H3/*"}, false, 1.0, 3,
               AccusationsPerHour);
  std::vector<const Group*> usual, hard;
  for (const Group& group : summary.honest) {
    (group.id == "H4" || group.id == "H12" ? hard : usual).push_back(&group);
  }
  judge.Add("validated share, each condition but H4 and H12", usual, true, 0.95, 3, Validated);
  judge.Add("validated share, H4 and H12", hard, true, 0.80, 3, Validated);
  if (!summary.honest.empty() || summary.plain) {
    judge.Add("occlusions of 3..6 s survived", {&all}, true, 0.90, 3, Survival);
  }
  return judge.Finish();
}

}  // namespace v2vouch::campaign
