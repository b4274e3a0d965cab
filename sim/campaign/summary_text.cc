// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "sim/campaign/summary.h"
#include "sim/campaign/summary_warnings.h"
#include "sim/campaign/targets.h"
#include "sim/plot/svg.h"

namespace v2vouch::campaign {
namespace {

using evaluation::AttackFigures;
using evaluation::Fixed;
using evaluation::HonestTreatment;
using evaluation::PooledF1;
using Json = nlohmann::ordered_json;

Json Optional(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json Ratio(double part, double whole) { return whole > 0.0 ? Json(part / whole) : Json(nullptr); }

// Whether a percentile is missing because its attacker was never met.
bool IsCensored(const AttackFigures& figures, double share) {
  return figures.met_after.count() > 0 && !figures.met_after.Percentile(share);
}

Json HonestJson(const HonestTreatment& h) {
  const double hours = h.vehicle_s / 3600.0;
  return {{"vehicle_hours", hours},
          {"accusations", h.accusations},
          {"accusations_per_vehicle_hour", Ratio(h.accusations, hours)},
          {"withdrawals", h.withdrawals},
          {"withdrawn_share", Ratio(h.withdrawn_s, h.vehicle_s)},
          {"validated_share", Ratio(h.validated, h.in_view)},
          {"held_share", Ratio(h.held_s, h.holdable_s)},
          {"occlusions", h.bridges},
          {"bridging_survival", Ratio(h.bridges_survived, h.bridges)},
          {"occlusions_in_budget", h.bridges_in_budget},
          {"survival_in_budget", Ratio(h.survived_in_budget, h.bridges_in_budget)},
          {"ids_kept", Ratio(h.bridges_same_id, h.bridges_survived)}};
}

Json FieldJson(const Group& group) {
  Json field = Json::object();
  if (group.paper) {
    field["paper"] = {{"f1", Optional(group.paper->by_message.f1)},
                      {"exposure_max_m", group.paper->exposure_max_m},
                      {"ghost_publications", group.paper->ghosts}};
  }
  if (const auto& checks = group.attack.checks_by_message) {
    field["message_checks"] = {{"precision", Optional(checks->counts.precision())},
                               {"recall", Optional(checks->counts.recall())},
                               {"f1", Optional(checks->f1)},
                               {"f1_low", Optional(checks->low)},
                               {"f1_high", Optional(checks->high)},
                               {"f1_per_source", Optional(group.attack.checks_by_source->f1)}};
  }
  return field;
}

Json AttackJson(const Group& group) {
  const AttackFigures& a = group.attack;
  const PooledF1& f1 = a.by_message;
  Json json = {{"runs", a.runs},
               {"sources", a.sources},
               {"withdraw_rate", Optional(a.withdraw_rate())},
               {"withdraw_p50_s", Optional(a.met_after.Percentile(0.5))},
               {"withdraw_p95_s", Optional(a.met_after.Percentile(0.95))},
               {"withdraw_p50_censored", IsCensored(a, 0.5)},
               {"withdraw_p95_censored", IsCensored(a, 0.95)},
               {"accuse_rate", Optional(a.accuse_rate())},
               {"messages", f1.counts.true_positive + f1.counts.false_negative},
               {"precision", Optional(f1.counts.precision())},
               {"recall", Optional(f1.counts.recall())},
               {"f1", Optional(f1.f1)},
               {"f1_low", Optional(f1.low)},
               {"f1_high", Optional(f1.high)},
               {"f1_per_source", Optional(a.by_source.f1)},
               {"false_positive_rate", Optional(f1.counts.false_positive_rate())},
               {"agent_accuracy", Optional(a.by_source.counts.accuracy())},
               {"named_accuracy", Optional(group.named_accuracy())},
               {"exposure_max_m", a.exposure_max_m},
               {"exposure_p95_m", a.exposure_p95_m},
               {"exposure_over_3m_s_per_run", a.harm_s},
               {"lingered_in_clear_view_s", a.lingered_max_s},
               {"original_max_m", a.original_max_m},
               {"ghost_publications", a.ghosts},
               {"ghosts_of_attackers", a.ghosts_of_attackers},
               {"outnumbered_instants", a.outnumbered},
               {"doubled_instants", a.doubled},
               {"local_digests_compared", group.digests_compared},
               {"local_digests_changed", group.digests_changed},
               {"validated_ratio", Optional(group.validated_ratio)},
               {"score", Optional(a.score())},
               {"honest", HonestJson(a.honest)}};
  if (group.gospa) json["gospa"] = GospaJson(*group.gospa);
  if (group.warnings) json["warnings"] = WarningsJson(*group.warnings);
  if (Json field = FieldJson(group); !field.empty()) json["field"] = std::move(field);
  return json;
}

Json EntryJson(const Group& group, bool is_attack) {
  Json entry = {{"id", group.id}};
  const auto fill = [is_attack](const Group& from, Json& into) {
    if (is_attack) {
      into.update(AttackJson(from));
    } else {
      into["runs"] = from.attack.runs;
      into.update(HonestJson(from.attack.honest));
      if (from.warnings) into["warnings"] = WarningsJson(*from.warnings);
    }
  };
  fill(group, entry);
  if (group.variants.empty()) return entry;
  entry["variants"] = Json::array();
  for (const Group& variant : group.variants) {
    Json of_variant = {{"name", variant.variant}};
    fill(variant, of_variant);
    entry["variants"].push_back(std::move(of_variant));
  }
  return entry;
}

std::string Padded(const std::string& text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 1, ' ');
}

std::string Cell(const std::optional<double>& value, int digits, std::size_t width = 8) {
  const std::string text = value ? Fixed(*value, digits) : std::string("none");
  return std::string(text.size() < width ? width - text.size() : 1, ' ') + text;
}

std::string Time(const AttackFigures& figures, double share) {
  const std::string text = IsCensored(figures, share) ? "never" : "";
  if (text.empty()) return Cell(figures.met_after.Percentile(share), 2);
  return std::string(8 - text.size(), ' ') + text;
}

std::optional<double> Number(double value) { return value; }

std::optional<double> Share(double part, double whole) {
  return whole > 0.0 ? std::optional(part / whole) : std::nullopt;
}

std::string AttackLine(const Group& group, bool is_variant) {
  const AttackFigures& a = group.attack;
  return Padded(is_variant ? "  " + group.variant : group.id, 24) + Cell(Number(a.runs), 0, 5) +
         Cell(Number(a.sources), 0, 6) + Cell(a.withdraw_rate(), 2, 7) + Time(a, 0.5) +
         Time(a, 0.95) + Cell(a.accuse_rate(), 2, 7) + Cell(a.by_message.f1, 3, 7) +
         Cell(a.by_message.low, 3, 7) + Cell(a.by_message.high, 3, 7) + Cell(a.by_source.f1, 3, 7) +
         Cell(Number(a.exposure_max_m), 1) + Cell(Number(a.ghosts), 0, 7) +
         Cell(Number(a.ghosts_of_attackers), 0, 5) + Cell(Number(group.digests_changed), 0, 6) +
         "\n";
}

std::string HonestLine(const Group& group, bool is_variant) {
  const HonestTreatment& h = group.attack.honest;
  const double hours = h.vehicle_s / 3600.0;
  return Padded(is_variant ? "  " + group.variant : group.id, 24) +
         Cell(Number(group.attack.runs), 0, 5) + Cell(Number(hours), 2) +
         Cell(Share(h.accusations, hours), 2) + Cell(Share(100.0 * h.withdrawn_s, h.vehicle_s), 2) +
         Cell(Share(100.0 * h.validated, h.in_view), 1) +
         Cell(Share(100.0 * h.held_s, h.holdable_s), 1) + Cell(Number(h.bridges), 0) +
         Cell(Share(100.0 * h.bridges_survived, h.bridges), 1) +
         Cell(Share(100.0 * h.survived_in_budget, h.bridges_in_budget), 1) +
         Cell(Share(100.0 * h.bridges_same_id, h.bridges_survived), 1) + "\n";
}

template <class Line>
std::string Lines(const std::vector<Group>& groups, Line line) {
  std::string out;
  for (const Group& group : groups) {
    out += line(group, false);
    for (const Group& variant : group.variants) out += line(variant, true);
  }
  return out;
}

std::string FieldLine(const Group& group, bool is_variant) {
  const AttackFigures& a = group.attack;
  const auto& checks = a.checks_by_message;
  const auto& paper = group.paper;
  const auto of = [](const auto& figures, auto get) {
    return figures ? std::optional<double>(get(*figures)) : std::nullopt;
  };
  return Padded(is_variant ? "  " + group.variant : group.id, 24) + Cell(a.by_message.f1, 3) +
         Cell(checks ? checks->f1 : std::nullopt, 3) +
         Cell(paper ? paper->by_message.f1 : std::nullopt, 3) +
         Cell(a.by_message.counts.precision(), 3, 10) +
         Cell(checks ? checks->counts.precision() : std::nullopt, 3) +
         Cell(Number(a.exposure_max_m), 1, 10) +
         Cell(of(paper, [](const AttackFigures& p) { return p.exposure_max_m; }), 1) +
         Cell(Number(a.ghosts), 0, 10) +
         Cell(of(paper, [](const AttackFigures& p) { return 1.0 * p.ghosts; }), 0) + "\n";
}

}  // namespace

std::string SummaryJson(const Summary& summary) {
  Json json = {{"attacks", Json::array()}, {"honest", Json::array()}};
  for (const Group& group : summary.attacks) json["attacks"].push_back(EntryJson(group, true));
  for (const Group& group : summary.honest) json["honest"].push_back(EntryJson(group, false));
  json["plain"] = nullptr;
  if (summary.plain) {
    json["plain"] = {{"runs", summary.plain->attack.runs}};
    json["plain"].update(HonestJson(summary.plain->attack.honest));
    if (summary.plain->warnings) json["plain"]["warnings"] = WarningsJson(*summary.plain->warnings);
  }
  json["phantoms"] = PhantomsJson(summary);
  json["attacked_warnings"] = nullptr;
  if (summary.attacked_warnings) {
    json["attacked_warnings"] = WarningsJson(*summary.attacked_warnings);
  }
  json["score"] = Optional(summary.score);
  json["weakest"] = summary.weakest.empty() ? Json(nullptr) : Json(summary.weakest);
  json["targets"] = Json::array();
  for (const Target& target : JudgeTargets(summary)) {
    json["targets"].push_back(
        {{"what", target.what},
         {"limit", target.LimitText()},
         {"value", Optional(target.value)},
         {"censored", target.is_censored},
         {"met", target.value || target.is_censored ? Json(target.is_met()) : Json(nullptr)}});
  }
  json["runs"] = summary.runs;
  return json.dump() + "\n";
}

std::string SummaryTable(const Summary& summary, bool field) {
  std::string out;
  if (!summary.attacks.empty()) {
    out += Padded("attack", 24) +
           " runs   src   met   p50[s]  p95[s] accuse     F1    low   high F1/src  exp[m] ghosts"
           "  its LOCAL\n";
    out += Lines(summary.attacks, AttackLine);
  }
  if (!summary.honest.empty() || summary.plain) {
    out += Padded("honest", 24) +
           " runs   veh-h   acc/h wdrawn%  valid%   held%   occls surviv% budget%   same%\n";
    if (summary.plain) {
      Group plain = *summary.plain;
      plain.id = "(no overlay)";
      out += HonestLine(plain, false);
    }
    out += Lines(summary.honest, HonestLine);
  }
  if (field && !summary.attacks.empty()) {
    out += Padded("against the field", 24) +
           "      F1                   precision          exposure[m]         ghosts\n" +
           Padded("", 24) +
           "    ours  checks   paper      ours  checks      ours   paper      ours   paper\n";
    out += Lines(summary.attacks, FieldLine);
  }
  out += AgentsTable(summary) + WarningsTable(summary);
  out += "targets\n";
  for (const Target& target : JudgeTargets(summary)) {
    const std::string verdict = !target.value && !target.is_censored ? "not measured"
                                : target.is_met()                    ? "met"
                                                                     : "MISSED";
    out += "  " + Padded(verdict, 14) + Padded(target.what, 62) + target.LimitText() + ", is " +
           target.ValueText() + "\n";
  }
  out += "score " + (summary.score ? Fixed(*summary.score, 1) : std::string("none")) +
         (summary.weakest.empty() ? "" : ", weakest " + summary.weakest) + "; " +
         std::to_string(summary.runs) + " runs\n";
  return out;
}

}  // namespace v2vouch::campaign
