// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace v2vouch::campaign {
namespace {

using evaluation::AttackFigures;
using evaluation::HonestTreatment;
using evaluation::SpoofRun;

// What identifies the world an overlay was laid over.
using World = std::tuple<std::string, int, std::uint64_t>;

World WorldOf(const Job& job) { return {job.scenario_name(), job.density, job.seed}; }

// A2 before A11, "A5" before a user's "my_attack".
std::tuple<bool, char, int, std::string> Order(const std::string& id) {
  const bool is_catalogue = id.size() >= 2 && (id[0] == 'A' || id[0] == 'H') &&
                            id.find_first_not_of("0123456789", 1) == std::string::npos &&
                            id.size() < 7;
  if (!is_catalogue) return {true, '~', 0, id};
  return {false, id[0], std::stoi(id.substr(1)), id};
}

// Adds an attacked run and the same without attack, where both have the lists.
void AddGospa(const SpoofRun& with, const SpoofRun& without,
              std::optional<GospaUnderAttack>& sums) {
  const auto &a = with.gospa, &b = without.gospa;
  if (!a.v2v || !a.priority || !a.local || !b.v2v || !b.priority || !b.local) return;
  if (!sums) sums.emplace();
  ++sums->runs;
  sums->v2v_m += *a.v2v;
  sums->v2v_plain_m += *b.v2v;
  sums->priority_m += *a.priority;
  sums->priority_plain_m += *b.priority;
  sums->local_m += *a.local;
  sums->local_plain_m += *b.local;
}

void MakeMeans(GospaUnderAttack& gospa) {
  for (double* sum : {&gospa.v2v_m, &gospa.v2v_plain_m, &gospa.priority_m, &gospa.priority_plain_m,
                      &gospa.local_m, &gospa.local_plain_m}) {
    *sum /= gospa.runs;
  }
}

Group Pool(const std::vector<const RunRecord*>& records,
           const std::map<World, const RunRecord*>& plain) {
  Group group;
  group.id = records.front()->job.overlay.id;
  std::vector<const SpoofRun*> ours, papers;
  HonestTreatment with, without;
  for (const RunRecord* record : records) {
    ours.push_back(&record->ours);
    if (record->paper) papers.push_back(&*record->paper);
    group.step_max_us = std::max(group.step_max_us, record->step_max_us);
    if (record->warnings) {
      if (!group.warnings) group.warnings.emplace();
      group.warnings->Add(*record->warnings);
    }
    if (record->job.overlay.kind != Kind::kAttack) continue;
    const auto reference = plain.find(WorldOf(record->job));
    if (reference == plain.end()) continue;
    ++group.digests_compared;
    if (reference->second->local_digest != record->local_digest) ++group.digests_changed;
    with.Add(record->ours.honest);
    without.Add(reference->second->ours.honest);
    AddGospa(record->ours, reference->second->ours, group.gospa);
  }
  if (group.gospa) MakeMeans(*group.gospa);
  group.attack = evaluation::PoolAttack(ours);
  if (!papers.empty()) group.paper = evaluation::PoolAttack(papers);
  const auto share = [](const HonestTreatment& h) { return 1.0 * h.validated / h.in_view; };
  if (with.in_view > 0 && without.validated > 0) {
    group.validated_ratio = share(with) / share(without);
  }
  return group;
}

std::vector<Group> GroupsOf(Kind kind, const std::vector<RunRecord>& records,
                            const std::map<World, const RunRecord*>& plain) {
  std::map<std::string, std::vector<const RunRecord*>> by_id;
  for (const RunRecord& record : records) {
    if (record.job.overlay.kind == kind) by_id[record.job.overlay.id].push_back(&record);
  }
  std::vector<Group> groups;
  for (const auto& [id, of_id] : by_id) {
    Group group = Pool(of_id, plain);
    std::map<std::string, std::vector<const RunRecord*>> by_variant;
    for (const RunRecord* record : of_id) by_variant[record->job.overlay.variant].push_back(record);
    for (const auto& [variant, of_variant] : by_variant) {
      if (by_variant.size() == 1 && variant.empty()) continue;
      group.variants.push_back(Pool(of_variant, plain));
      group.variants.back().variant = variant;
    }
    groups.push_back(std::move(group));
  }
  std::sort(groups.begin(), groups.end(),
            [](const Group& a, const Group& b) { return Order(a.id) < Order(b.id); });
  return groups;
}

}  // namespace

std::optional<double> GospaUnderAttack::averted() const {
  const double added_m = v2v_m - v2v_plain_m;
  if (added_m < 0.1) return std::nullopt;
  return 1.0 - (priority_m - priority_plain_m) / added_m;
}

std::optional<double> Group::named_accuracy() const {
  const int devices = attack.sources + attack.honest.senders;
  if (devices == 0) return std::nullopt;
  return 1.0 * (attack.accused + attack.honest.senders - attack.honest.accused) / devices;
}

Summary Summarise(const std::vector<RunRecord>& records) {
  Summary summary;
  summary.runs = static_cast<int>(records.size());
  std::map<World, const RunRecord*> plain;
  std::vector<const RunRecord*> plain_records;
  for (const RunRecord& record : records) {
    if (record.job.overlay.kind != Kind::kPlain) continue;
    plain[WorldOf(record.job)] = &record;
    plain_records.push_back(&record);
  }
  if (!plain_records.empty()) summary.plain = Pool(plain_records, plain);
  summary.attacks = GroupsOf(Kind::kAttack, records, plain);
  summary.honest = GroupsOf(Kind::kHonest, records, plain);
  for (const Group& group : summary.honest) summary.all_honest.Add(group.attack.honest);
  if (summary.honest.empty() && summary.plain) summary.all_honest = summary.plain->attack.honest;
  std::optional<double> weakest;
  for (const Group& group : summary.attacks) {
    for (const char* phantom : {"A1", "A2", "A3", "A4", "A11"}) {
      if (group.id != phantom) continue;
      summary.phantom_messages.Add(group.attack.by_message.counts);
      summary.phantom_sources.Add(group.attack.by_source.counts);
    }
    if (group.warnings) {
      if (!summary.attacked_warnings) summary.attacked_warnings.emplace();
      summary.attacked_warnings->Add(*group.warnings);
    }
    const auto score = group.attack.score();
    if (!score || group.id == "A28" || (weakest && *score >= *weakest)) continue;
    weakest = score;
    summary.weakest = group.id;
  }
  summary.score = evaluation::CompositeScore(weakest, summary.all_honest);
  return summary;
}

}  // namespace v2vouch::campaign
