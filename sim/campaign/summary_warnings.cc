// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/summary_warnings.h"

#include <array>
#include <functional>
#include <utility>

#include "sim/plot/svg.h"

namespace v2vouch::campaign {
namespace {

using evaluation::ConsumerTally;
using evaluation::Fixed;
using evaluation::WarnTally;
using Json = nlohmann::ordered_json;

Json Optional(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json ConsumerJson(const ConsumerTally& tally) {
  return {{"true", tally.true_count},
          {"late", tally.late},
          {"early", tally.early},
          {"missed", tally.missed},
          {"unavoidable", tally.unavoidable},
          {"false", tally.false_count},
          {"false_by_lie", tally.false_by_lie},
          {"urgent", tally.urgent},
          {"urgent_false", tally.urgent_false},
          {"urgent_by_lie", tally.urgent_by_lie},
          {"runs_with_urgent_by_lie", tally.runs_by_lie},
          {"planner_contacts", tally.planner_contacts},
          {"driver_contacts", tally.driver_contacts},
          {"planner_needless", tally.planner_needless},
          {"driver_needless", tally.driver_needless},
          {"needless_speed_lost_mps", tally.speed_lost_mps},
          {"delay_p95_s", Optional(tally.delay_p95_s())}};
}

Json DetectedJson(const evaluation::Confusion& counts) {
  return {{"false", counts.true_positive + counts.false_negative},
          {"honest", counts.false_positive + counts.true_negative},
          {"detected_share", Optional(counts.recall())},
          {"false_positive_rate", Optional(counts.false_positive_rate())},
          {"accuracy", Optional(counts.accuracy())}};
}

std::string Padded(const std::string& text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 1, ' ');
}

std::string Cell(const std::string& text, std::size_t width) {
  return std::string(text.size() < width ? width - text.size() : 1, ' ') + text;
}

std::string Cell(const std::optional<double>& value, int digits, std::size_t width) {
  return Cell(value ? Fixed(*value, digits) : std::string("none"), width);
}

// Ids and their variants, each with the name it has in tables.
void Each(const std::vector<Group>& groups,
          const std::function<void(const Group&, const std::string&)>& take) {
  for (const Group& group : groups) {
    take(group, group.id);
    for (const Group& variant : group.variants) take(variant, "  " + variant.variant);
  }
}

std::string ConsumerCells(const ConsumerTally& tally) {
  std::string out = " |";
  for (const int count :
       {tally.urgent_by_lie, tally.urgent_false, tally.false_count, tally.true_count, tally.late,
        tally.missed, tally.planner_contacts, tally.planner_needless}) {
    out += Cell(std::to_string(count), 5);
  }
  return out;
}

std::string WarningsLine(const std::string& name, const WarnTally& tally) {
  return Padded(name, 24) + Cell(std::to_string(tally.runs), 5) +
         Cell(std::to_string(tally.contacts_unwarned), 5) + ConsumerCells(tally.v2v) +
         ConsumerCells(tally.local) + ConsumerCells(tally.ours) + "\n";
}

}  // namespace

Json WarningsJson(const WarnTally& tally) {
  return {{"runs", tally.runs},
          {"seconds", tally.seconds},
          {"contacts_unwarned", tally.contacts_unwarned},
          {"v2v", ConsumerJson(tally.v2v)},
          {"local", ConsumerJson(tally.local)},
          {"ours", ConsumerJson(tally.ours)}};
}

Json GospaJson(const GospaUnderAttack& gospa) {
  const auto of = [](double with_m, double without_m) -> Json {
    return {{"mean_m", with_m},
            {"without_attack_m", without_m},
            {"ratio", without_m > 0.0 ? Json(with_m / without_m) : Json(nullptr)}};
  };
  return {{"runs", gospa.runs},
          {"v2v", of(gospa.v2v_m, gospa.v2v_plain_m)},
          {"priority", of(gospa.priority_m, gospa.priority_plain_m)},
          {"local", of(gospa.local_m, gospa.local_plain_m)},
          {"averted", Optional(gospa.averted())}};
}

Json PhantomsJson(const Summary& summary) {
  return {{"by_message", DetectedJson(summary.phantom_messages)},
          {"by_source", DetectedJson(summary.phantom_sources)}};
}

std::string WarningsTable(const Summary& summary) {
  std::string lines;
  if (summary.plain && summary.plain->warnings) {
    lines += WarningsLine("(no overlay)", *summary.plain->warnings);
  }
  const auto add = [&lines](const Group& group, const std::string& name) {
    if (group.warnings) lines += WarningsLine(name, *group.warnings);
  };
  Each(summary.attacks, add);
  if (summary.attacked_warnings) lines += WarningsLine("all attacks", *summary.attacked_warnings);
  Each(summary.honest, add);
  if (lines.empty()) return "";
  std::string out = Padded("warnings", 24) + "          ";
  for (const char* consumer : {"V2V alone", "LOCAL", "ours"}) out += " | " + Padded(consumer, 39);
  out += "\n" + Padded("", 24) + " runs cont";
  for (int i = 0; i < 3; ++i) out += " |  lie Ufals false true late miss  cont need";
  return out + "\n" + lines +
         "  cont: runs with a contact (nobody brakes; planner brakes); lie: URGENT caused by a "
         "lie;\n  Ufals: URGENT false, for whatever cause; need: runs with needless braking\n";
}

std::string AgentsTable(const Summary& summary) {
  if (summary.attacks.empty()) return "";
  std::string out = Padded("agents", 24) +
                    "  GOSPA with/without attack [m]        averted detect   FPR  agents  named\n" +
                    Padded("", 24) + "        V2V          PRIORITY\n";
  Each(summary.attacks, [&out](const Group& group, const std::string& name) {
    const auto& counts = group.attack.by_message.counts;
    const auto pair = [&](double GospaUnderAttack::*with, double GospaUnderAttack::*without) {
      if (!group.gospa) return Cell(std::string("none"), 18);
      return Cell((*group.gospa).*with, 2, 9) + Cell((*group.gospa).*without, 2, 9);
    };
    out += Padded(name, 24) + pair(&GospaUnderAttack::v2v_m, &GospaUnderAttack::v2v_plain_m) +
           pair(&GospaUnderAttack::priority_m, &GospaUnderAttack::priority_plain_m) +
           Cell(group.gospa ? group.gospa->averted() : std::nullopt, 2, 10) +
           Cell(counts.recall(), 3, 7) + Cell(counts.false_positive_rate(), 4, 7) +
           Cell(group.attack.by_source.counts.accuracy(), 3, 7) +
           Cell(group.named_accuracy(), 3, 7) + "\n";
  });
  const auto& phantoms = summary.phantom_messages;
  if (!phantoms.recall()) return out;
  return out + "  phantoms (A1-A4, A11): " + Fixed(100.0 * *phantoms.recall(), 1) +
         " % of their messages detected at a false-positive rate of " +
         (phantoms.false_positive_rate() ? Fixed(100.0 * *phantoms.false_positive_rate(), 2) + " %"
                                         : std::string("none")) +
         "\n";
}

}  // namespace v2vouch::campaign
