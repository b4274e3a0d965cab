// SPDX-License-Identifier: Apache-2.0
#include "sim/report/report_tables.h"

#include <cmath>

#include "sim/plot/svg.h"
#include "sim/report/behaviour_text.h"

namespace v2vouch::evaluation {
namespace {

struct PaperRow {
  double gospa, missed, false_tracks, switching;
};
// Its table of means. Localisation is not in it: it follows from the other parts (p = 2, c = 30).
constexpr PaperRow kPaperTable[] = {
    {56.12, 30.0, 47.43, 0.0}, {7.517, 0.0, 0.0, 0.0}, {48.62, 21.2, 42.43, 0.0}};

std::string Cells(std::initializer_list<double> values, int digits) {
  std::string out;
  for (const double value : values) out += "<td>" + Fixed(value, digits) + "</td>";
  return out;
}

std::string ScoreCells(const ListScore& s) {
  return Cells({s.gospa_mean, s.localisation_mean, s.missed_mean, s.false_mean, s.switching_mean},
               2);
}

std::string GateTitle(const std::string& name) {
  const std::string list = name.starts_with("local") ? "LOCAL " : "PRIORITY ";
  if (name.ends_with("localisation_ratio"))
    return list + "localisation of visible vehicles / bound";
  if (name.ends_with("excess_missed_share")) return list + "missed beyond the unavoidable";
  return list + "false tracks per instant";
}

std::string ComparisonAt(const Evaluation& evaluation, const Evaluation* paper, double cutoff_m,
                         Against against) {
  const auto& pick = [&](const Evaluation& e) -> const std::vector<ListScore>& {
    const CutoffScores& scores = e.at_cutoff(cutoff_m);
    return against == Against::kOwnScope ? scores.own : scores.all;
  };
  std::string out =
      "<table><tr><th>c = " + Number(cutoff_m) + " m, " +
      (against == Against::kOwnScope ? "each list against its own scope"
                                     : "every list against every vehicle") +
      "</th><th>GOSPA</th><th>localisation</th><th>missed</th><th>false</th><th>switching</th>"
      "<th>ratio to bound</th></tr>\n";
  for (const ListKind kind : kLists) {
    const ListScore& ours = pick(evaluation)[Index(kind)];
    out += std::string("<tr class=\"list\"><td class=\"") + ListKey(kind) + "\" colspan=\"7\">" +
           ListTitle(kind) + "</td></tr>\n";
    if (against == Against::kAllVehicles && cutoff_m == 30.0) {
      const PaperRow& row = kPaperTable[Index(kind)];
      out += "<tr><td>the paper, its own scenario</td>" + Cells({row.gospa}, 2) +
             "<td>not given</td>" + Cells({row.missed, row.false_tracks, row.switching}, 2) +
             "<td></td></tr>\n";
    }
    if (paper != nullptr) {
      const ListScore& theirs = pick(*paper)[Index(kind)];
      out += "<tr><td>the paper's association, this run</td>" + ScoreCells(theirs) + "<td>" +
             Fixed(theirs.ratio(), 2) + "</td></tr>\n";
    }
    out += "<tr class=\"ours\"><td>V2Vouch, this run</td>" + ScoreCells(ours) + "<td>" +
           Fixed(ours.ratio(), 2) + "</td></tr>\n";
    out += "<tr class=\"bound\"><td>bound, this run</td>" + Cells({ours.bound_mean}, 2) +
           "<td></td>" + Cells({ours.bound_missed_mean, 0.0, 0.0}, 2) + "<td></td></tr>\n";
  }
  return out + "</table>\n";
}

}  // namespace

std::string GatesHtml(const Evaluation& evaluation) {
  std::string out = "<div class=\"gates\">\n";
  for (const Gate& gate : evaluation.gates) {
    const bool is_share = gate.name.ends_with("share");
    const double scale = is_share ? 100.0 : 1.0;
    const char* unit = is_share ? " %" : "";
    out += std::string("<div class=\"gate") + (gate.passes() ? "" : " miss") +
           "\"><div class=\"what\">" + GateTitle(gate.name) + "</div><b>" +
           (gate.has_value() ? Number(scale * gate.value, is_share ? 1 : 3) + unit : "none") +
           "</b> <span class=\"limit\">" + (gate.passes() ? "ok, " : "missed, ") + "at most " +
           Number(scale * gate.limit) + unit + "</span></div>\n";
  }
  return out + "</div>\n";
}

std::string ComparisonHtml(const Evaluation& evaluation, const Evaluation* paper) {
  std::string out =
      ComparisonAt(evaluation, paper, evaluation.settings.cutoff_m, Against::kOwnScope);
  if (evaluation.settings.cutoff_m != 10.0) {
    out += ComparisonAt(evaluation, paper, 10.0, Against::kOwnScope);
  }
  if (evaluation.settings.cutoff_m != 30.0) {
    out += ComparisonAt(evaluation, paper, 30.0, Against::kOwnScope);
  }
  return out + ComparisonAt(evaluation, paper, 30.0, Against::kAllVehicles);
}

std::string DetailsHtml(const Evaluation& evaluation) {
  std::string out =
      "<table><tr><th></th><th class=\"local\">LOCAL</th><th class=\"v2v\">V2V</th>"
      "<th class=\"priority\">PRIORITY</th></tr>\n";
  const auto row = [&](const std::string& name, int digits, const auto& value) {
    out += "<tr><td>" + name + "</td>";
    for (const ListKind kind : kLists) {
      out += "<td>" + Fixed(value(evaluation.headline(kind)), digits) + "</td>";
    }
    out += "</tr>\n";
  };
  row("GOSPA, RMS over instants [m]", 3, [](const ListScore& s) { return s.gospa_rms; });
  row("bound from any second look, without validation time [m]", 3,
      [](const ListScore& s) { return s.bound_mean_plain; });
  row("position error of visible vehicles, RMS [m]", 3,
      [](const ListScore& s) { return s.localisation_rms_m; });
  row("position error of all vehicles held, RMS [m]", 3,
      [](const ListScore& s) { return s.localisation_all_rms_m; });
  const auto anees_row = [&](const std::string& name, Anees ListScore::*which) {
    out += "<tr><td>" + name + "</td>";
    for (const ListKind kind : kLists) {
      out += "<td>" + AneesText(evaluation.headline(kind).*which) + "</td>";
    }
    out += "</tr>\n";
  };
  anees_row("ANEES visible (ideal 2; 95 % band)", &ListScore::visible);
  anees_row("ANEES hidden", &ListScore::hidden);
  anees_row("ANEES out of view", &ListScore::out_of_view);
  row("T-GOSPA per instant [m]", 3, [](const ListScore& s) { return s.trajectory_per_step; });
  row("vehicles followed by another track than before", 0,
      [](const ListScore& s) { return s.switches; });
  row("switches, losses and returns counted half", 1,
      [](const ListScore& s) { return s.switch_halves; });
  row("distinct false tracks", 0, [](const ListScore& s) { return s.false_track_ids; });
  row("vehicle-seconds", 1, [](const ListScore& s) { return s.vehicle_seconds; });
  row("... missed", 1, [](const ListScore& s) { return s.missed_seconds; });
  row("... unavoidably", 1, [](const ListScore& s) { return s.bound_missed_seconds; });
  row("... missed although the bound holds them", 1,
      [](const ListScore& s) { return s.excess_missed_seconds; });
  out += "</table>\n<p>Kept by PRIORITY while hidden: " + UnseenText(evaluation.hidden) +
         "; while out of view: " + UnseenText(evaluation.out_of_view) +
         ". Validated share of the time it was possible: " +
         WithUnit(100.0 * evaluation.validated_share, 1, " %") + ".</p>\n<p>Seconds in PRIORITY: ";
  bool is_first = true;
  for (const auto& [id, seconds] : evaluation.hold_s) {
    out += (is_first ? "vehicle " : "; vehicle ") + std::to_string(id) + ": " + Number(seconds, 1);
    is_first = false;
  }
  return out + (is_first ? "none" : "") + ".</p>\n";
}

std::string DefinitionsHtml(const Evaluation& evaluation) {
  return "<p class=\"note\"><b>GOSPA</b>: order 2, alpha 2; at each instant the newest list "
         "received "
         "by then, carried to the instant at constant turn rate and acceleration; centres of "
         "footprints; matched to all vehicles in scope first, pairs outside the disc dropped then; "
         "the first second is skipped. It grows with the number of missed and false vehicles and "
         "is "
         "not divided by it. Switching penalty: " +
         Number(evaluation.settings.switching()) +
         " m, reported as its own part and not in GOSPA.</p>\n"
         "<p class=\"note\"><b>Bound</b>: posterior Cram&eacute;r-Rao recursion along each true "
         "path "
         "with that vehicle's own accelerations (Singer, 1.5 s; at least 0.5 and 0.3 m/s&sup2; "
         "along "
         "and across), the sensors' sigmas and true detection probabilities, exact ego pose, known "
         "reflection point and one reflection per look, so for extended vehicles it is the bound "
         "of "
         "point targets. LOCAL may miss a vehicle until its second look, and drops a hidden one "
         "when "
         "its expected squared error, cut off at 10 m, passes half of 10&sup2;. PRIORITY may miss "
         "it "
         "until 1.5 s after both the first BSM and the confirmation by own sensors, and beyond the "
         "bridging budget min(10 s, 2 s + co-observed time), at least 4.5 s. V2V: from the second "
         "BSM; a list that corrects its senders' biases by own sensors can be better than "
         "that.</p>\n"
         "<p class=\"note\"><b>Hidden</b>: inside the range and field of view of a sensor, but by "
         "truth geometry no ray reaches the vehicle. <b>Out of view</b>: outside of all of them. "
         "<b>T-GOSPA</b>: exact where a cluster of vehicles and "
         "tracks has at most 512 matchings, else an upper bound by beam search" +
         std::string(evaluation.headline(ListKind::kLocal).trajectory.is_exact
                         ? ""
                         : " (LOCAL here is such a bound)") +
         ".</p>\n";
}

}  // namespace v2vouch::evaluation
