// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/report.h"

#include <algorithm>

#include "daemon/rim/io/durable_file.h"
#include "sim/campaign/families.h"
#include "sim/campaign/report_plots.h"
#include "sim/campaign/targets.h"
#include "sim/plot/report_style.h"
#include "sim/plot/svg.h"

namespace v2vouch::campaign {
namespace {

using evaluation::AttackFigures;
using evaluation::Escape;
using evaluation::Fixed;
using evaluation::HonestTreatment;

std::string Cell(const std::string& text) { return "<td>" + text + "</td>"; }

std::string Cell(const std::optional<double>& value, int digits) {
  return Cell(value ? Fixed(*value, digits) : std::string("&ndash;"));
}

std::string Percent(double part, double whole) {
  return Cell(whole > 0.0 ? std::optional(100.0 * part / whole) : std::nullopt, 1);
}

std::string Time(const AttackFigures& figures, double share) {
  const auto time = figures.met_after.Percentile(share);
  if (!time && figures.met_after.count() > 0) return Cell("never");
  return Cell(time, 2);
}

std::string Header(const std::vector<const char*>& names) {
  std::string row = "<tr>";
  for (const char* name : names) row += std::string("<th>") + name + "</th>";
  return row + "</tr>\n";
}

/// Single variants, and ids that have none.
std::vector<const Group*> Leaves(const std::vector<Group>& groups) {
  std::vector<const Group*> leaves;
  for (const Group& group : groups) {
    if (group.variants.empty()) leaves.push_back(&group);
    for (const Group& variant : group.variants) leaves.push_back(&variant);
  }
  return leaves;
}

std::string TargetTable(const Summary& summary) {
  std::string rows = Header({"target", "wanted", "measured", ""});
  for (const Target& target : JudgeTargets(summary)) {
    const bool is_measured = target.value || target.is_censored;
    const char* verdict = !is_measured      ? "not measured"
                          : target.is_met() ? "<span class=\"priority\">met</span>"
                                            : "<b style=\"color:#c0392b\">missed</b>";
    rows += "<tr>" + Cell(Escape(target.what)) + Cell(Escape(target.LimitText())) +
            Cell(Escape(target.ValueText())) + Cell(verdict) + "</tr>\n";
  }
  return "<table>" + rows + "</table>\n";
}

std::string AttackTable(const std::vector<const Group*>& groups) {
  std::string rows =
      Header({"attack", "runs", "attackers", "met", "median [s]", "p95 [s]", "accused", "F1",
              "95 %", "per source", "exposure [m]", "&gt; 3 m [s/run]", "ghosts",
              "of these by attackers", "LOCAL changed"});
  for (const Group* group : groups) {
    const AttackFigures& a = group->attack;
    const auto& f1 = a.by_message;
    rows += "<tr>" + Cell(Escape(group->name())) + Cell(std::to_string(a.runs)) +
            Cell(std::to_string(a.sources)) + Cell(a.withdraw_rate(), 2) + Time(a, 0.5) +
            Time(a, 0.95) + Cell(a.accuse_rate(), 2) + Cell(f1.f1, 3) +
            Cell(f1.low ? Fixed(*f1.low, 2) + ".." + Fixed(*f1.high, 2) : std::string("&ndash;")) +
            Cell(a.by_source.f1, 3) + Cell(Fixed(a.exposure_max_m, 1)) + Cell(Fixed(a.harm_s, 2)) +
            Cell(std::to_string(a.ghosts)) + Cell(std::to_string(a.ghosts_of_attackers)) +
            Cell(group->digests_compared > 0 ? std::to_string(group->digests_changed) + " of " +
                                                   std::to_string(group->digests_compared)
                                             : std::string("&ndash;")) +
            "</tr>\n";
  }
  return "<table>" + rows + "</table>\n";
}

std::string HonestTable(const Summary& summary) {
  std::string rows =
      Header({"condition", "runs", "vehicle-hours", "accusations per hour", "withdrawn [% of time]",
              "validated [%]", "held [%]", "occlusions", "survived [%]",
              "of those within the budget [%]", "same id [%]", "ghosts"});
  const auto add = [&](const std::string& name, const Group& group) {
    const HonestTreatment& h = group.attack.honest;
    const double hours = h.vehicle_s / 3600.0;
    rows += "<tr>" + Cell(Escape(name)) + Cell(std::to_string(group.attack.runs)) +
            Cell(Fixed(hours, 2)) +
            Cell(hours > 0.0 ? std::optional(h.accusations / hours) : std::nullopt, 3) +
            Percent(h.withdrawn_s, h.vehicle_s) + Percent(h.validated, h.in_view) +
            Percent(h.held_s, h.holdable_s) + Cell(std::to_string(h.bridges)) +
            Percent(h.bridges_survived, h.bridges) +
            Percent(h.survived_in_budget, h.bridges_in_budget) +
            Percent(h.bridges_same_id, h.bridges_survived) +
            Cell(std::to_string(group.attack.ghosts)) + "</tr>\n";
  };
  if (summary.plain) add("no overlay", *summary.plain);
  for (const Group* group : Leaves(summary.honest)) add(group->name(), *group);
  return "<table>" + rows + "</table>\n";
}

std::string FieldTable(const std::vector<const Group*>& groups) {
  std::string rows =
      Header({"attack", "F1 ours", "F1 checks", "F1 paper", "F1 published (CaTCH)",
              "precision ours", "precision checks", "recall ours", "recall checks",
              "exposure ours [m]", "exposure paper [m]", "ghosts ours", "ghosts paper"});
  bool has_any = false;
  for (const Group* group : groups) {
    const AttackFigures& a = group->attack;
    const auto& checks = a.checks_by_message;
    const auto& paper = group->paper;
    if (!checks && !paper) continue;
    has_any = true;
    rows += "<tr>" + Cell(Escape(group->name())) + Cell(a.by_message.f1, 3) +
            Cell(checks ? checks->f1 : std::nullopt, 3) +
            Cell(paper ? paper->by_message.f1 : std::nullopt, 3) +
            Cell(PublishedF1(group->name()), 3) + Cell(a.by_message.counts.precision(), 3) +
            Cell(checks ? checks->counts.precision() : std::nullopt, 3) +
            Cell(a.by_message.counts.recall(), 3) +
            Cell(checks ? checks->counts.recall() : std::nullopt, 3) +
            Cell(Fixed(a.exposure_max_m, 1)) +
            Cell(paper ? Fixed(paper->exposure_max_m, 1) : std::string("&ndash;")) +
            Cell(std::to_string(a.ghosts)) +
            Cell(paper ? std::to_string(paper->ghosts) : std::string("&ndash;")) + "</tr>\n";
  }
  return has_any ? "<table>" + rows + "</table>\n" : "";
}

std::string WarningTable(const Summary& summary) {
  std::string rows =
      Header({"attack", "runs", "URGENT by a lie: V2V alone", "ours", "needless braking: V2V alone",
              "LOCAL", "ours", "true / late / missed: V2V alone", "LOCAL", "ours",
              "contacts, nobody brakes", "V2V alone", "LOCAL", "ours"});
  const auto add = [&rows](const std::string& name, const evaluation::WarnTally& w) {
    const auto found = [](const evaluation::ConsumerTally& t) {
      return Cell(std::to_string(t.true_count) + " / " + std::to_string(t.late) + " / " +
                  std::to_string(t.missed));
    };
    rows += "<tr>" + Cell(Escape(name)) + Cell(std::to_string(w.runs)) +
            Cell(std::to_string(w.v2v.urgent_by_lie)) + Cell(std::to_string(w.ours.urgent_by_lie));
    for (const auto* t : {&w.v2v, &w.local, &w.ours}) {
      rows += Cell(std::to_string(t->planner_needless));
    }
    rows +=
        found(w.v2v) + found(w.local) + found(w.ours) + Cell(std::to_string(w.contacts_unwarned));
    for (const auto* t : {&w.v2v, &w.local, &w.ours}) {
      rows += Cell(std::to_string(t->planner_contacts));
    }
    rows += "</tr>\n";
  };
  if (summary.plain && summary.plain->warnings) add("no overlay", *summary.plain->warnings);
  for (const Group& group : summary.attacks) {
    if (group.warnings) add(group.id, *group.warnings);
  }
  if (summary.attacked_warnings) add("all attacks", *summary.attacked_warnings);
  return "<table>" + rows + "</table>\n";
}

std::string Card(const std::string& title, const std::string& about, const std::string& content) {
  return "<section class=\"card\"><h2>" + Escape(title) + "</h2>\n<p class=\"note\">" +
         Escape(about) + "</p>\n" + content + "</section>\n";
}

std::string FamilyCard(const Family& family, const std::vector<const Group*>& groups,
                       const std::string& id) {
  return Card(family.title, family.about,
              AttackTable(groups) + F1Bars(groups) +
                  (id == "A7" ? DriftPlots(groups, id) : std::string()) +
                  ExposureOverTime(groups, id) + MetOverTime(groups, id));
}

std::string FamilyCards(const std::vector<const Group*>& leaves) {
  std::string cards;
  std::vector<const Group*> others = leaves;
  for (const Family& family : Families()) {
    std::vector<const Group*> of_family;
    for (const Group* group : leaves) {
      if (std::find(family.ids.begin(), family.ids.end(), group->id) == family.ids.end()) continue;
      of_family.push_back(group);
      std::erase(others, group);
    }
    if (!of_family.empty()) cards += FamilyCard(family, of_family, family.ids.front());
  }
  if (!others.empty()) cards += FamilyCard({"Others", "Files of your own.", {}}, others, "others");
  return cards;
}

}  // namespace

std::string ReportHtml(const Summary& summary) {
  const auto leaves = Leaves(summary.attacks);
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<title>Spoof resistance</title>\n<style>" +
      std::string(evaluation::ReportStyle()) +
      "main { width: 1240px; }\n</style></head>\n<body><main>\n";
  html += "<h1>Spoof resistance</h1>\n<div class=\"sub\">" + std::to_string(summary.runs) +
          " runs, " + std::to_string(leaves.size()) + " attacks, " +
          std::to_string(Leaves(summary.honest).size()) + " honest conditions; score " +
          (summary.score ? Fixed(*summary.score, 1) + " of 100" : std::string("not measured")) +
          (summary.weakest.empty() ? "" : ", set by " + Escape(summary.weakest)) + "</div>\n";
  html +=
      Card("Targets", "The worst of the attacks or conditions each covers.", TargetTable(summary));
  if (summary.attacked_warnings) {
    std::vector<const Group*> ids;
    for (const Group& group : summary.attacks) ids.push_back(&group);
    html += Card("Warnings",
                 "The engine of v2vouch-warn on three inputs: V2V taken for true, LOCAL, and both "
                 "lists. By a lie: false, of a vehicle whose track a liar's messages feed, and not "
                 "said by LOCAL alone.",
                 LieBars(ids) + WarningTable(summary));
  }
  html += FamilyCards(leaves);
  if (summary.plain || !summary.honest.empty()) {
    html += Card(
        "The honest",
        "Accusations per vehicle-hour heard within 150 m; time under SUSPECT or REVOKED; share "
        "of the time PRIORITY could hold honest vehicles and did; occlusions of 3 to 6 s.",
        HonestTable(summary));
  }
  if (const std::string field = FieldTable(leaves); !field.empty()) {
    html += Card(
        "Against the field",
        "The same runs by the paper's method, which knows no trust, and by message-only checks "
        "with the thresholds of F2MD's legacy checks; beside them what CaTCH reached on VeReMi "
        "NextGen's own data, the best of its four scenarios.",
        field);
  }
  return html + "</main></body></html>\n";
}

std::filesystem::path WriteReport(const std::filesystem::path& folder, const Summary& summary,
                                  std::string& problem) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const std::filesystem::path path = folder / "index.html";
  if (ReplaceFile(path.string(), ReportHtml(summary), problem)) return path;
  return {};
}

}  // namespace v2vouch::campaign
