// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "sim/behaviour/evaluation.h"
#include "sim/plot/svg.h"
#include "sim/report/behaviour_text.h"
#include "sim/report/scorecard_text.h"

namespace v2vouch::evaluation {
namespace {

using Json = nlohmann::ordered_json;

Json AneesJson(const Anees& anees) {
  return {{"anees", Rounded(anees.mean())},
          {"samples", anees.count},
          {"independent_samples", Rounded(anees.independent)},
          {"band_low", Rounded(anees.low)},
          {"band_high", Rounded(anees.high)},
          {"is_in_band", anees.is_in_band()}};
}

Json UnseenJson(const UnseenError& error) {
  return {{"rms_m", Rounded(error.rms_m)},
          {"max_m", Rounded(error.max_m)},
          {"seconds", Rounded(error.seconds)},
          {"possible_seconds", Rounded(error.possible_seconds)}};
}

Json Common(const ListScore& score) {
  return {{"gospa_mean", Rounded(score.gospa_mean)},
          {"gospa_rms", Rounded(score.gospa_rms)},
          {"localisation_mean", Rounded(score.localisation_mean)},
          {"missed_mean", Rounded(score.missed_mean)},
          {"false_mean", Rounded(score.false_mean)},
          {"switching_mean", Rounded(score.switching_mean)},
          {"switches", score.switches},
          {"false_tracks_total", score.false_instants},
          {"bound_mean", Rounded(score.bound_mean)},
          {"ratio", Rounded(score.ratio())},
          {"localisation_rms_m", Rounded(score.localisation_rms_m)},
          {"localisation_ratio", Rounded(score.localisation_ratio)},
          {"excess_missed_share", Rounded(score.excess_missed_share)}};
}

Json Full(const ListScore& score) {
  Json json = Common(score);
  json["has_lists"] = score.has_lists;
  json["localisation_extended_ratio"] = Rounded(score.localisation_extended_ratio);
  json["false_per_instant"] = Rounded(score.false_per_instant());
  json["false_track_ids"] = score.false_track_ids;
  json["switch_halves"] = score.switch_halves;
  json["bound_missed_mean"] = Rounded(score.bound_missed_mean);
  json["bound_mean_second_look"] = Rounded(score.bound_mean_plain);
  json["excess_missed_visible_share"] = Rounded(score.excess_missed_visible_share);
  json["excess_missed_share_second_look"] = Rounded(score.excess_missed_share_plain);
  json["localisation_all_rms_m"] = Rounded(score.localisation_all_rms_m);
  json["vehicle_seconds"] = Rounded(score.vehicle_seconds);
  json["missed_seconds"] = Rounded(score.missed_seconds);
  json["bound_missed_seconds"] = Rounded(score.bound_missed_seconds);
  json["excess_missed_seconds"] = Rounded(score.excess_missed_seconds);
  json["visible"] = AneesJson(score.visible);
  json["hidden"] = AneesJson(score.hidden);
  json["out_of_view"] = AneesJson(score.out_of_view);
  const double order = 2.0;
  json["t_gospa"] = {{"per_instant", Rounded(score.trajectory_per_step)},
                     {"total", Rounded(score.trajectory.tgospa)},
                     {"localisation", Rounded(Root(score.trajectory.localisation_pow, order))},
                     {"missed", Rounded(Root(score.trajectory.missed_pow, order))},
                     {"false", Rounded(Root(score.trajectory.false_pow, order))},
                     {"switching", Rounded(Root(score.trajectory.switch_pow, order))},
                     {"exact", score.trajectory.is_exact}};
  return json;
}

Json ListsJson(const std::vector<ListScore>& scores, bool is_full) {
  Json json;
  for (const ListScore& score : scores) {
    json[ListKey(score.kind)] = is_full ? Full(score) : Common(score);
  }
  return json;
}

void AppendScores(std::string& out, const char* title, const std::vector<ListScore>& scores) {
  out += Line("\n%s\n", title);
  out += "  list       GOSPA   (RMS)   local.  missed   false  switch |   bound   ratio\n";
  for (const ListScore& s : scores) {
    out += Line("  %-8s %7s %7s  %7s %7s %7s %7s | %7s %7s\n", ListTitle(s.kind),
                Fixed(s.gospa_mean, 3).c_str(), Fixed(s.gospa_rms, 3).c_str(),
                Fixed(s.localisation_mean, 3).c_str(), Fixed(s.missed_mean, 3).c_str(),
                Fixed(s.false_mean, 3).c_str(), Fixed(s.switching_mean, 3).c_str(),
                Fixed(s.bound_mean, 3).c_str(), Fixed(s.ratio(), 2).c_str());
  }
}

std::string GatesTable(const Evaluation& evaluation) {
  std::string out;
  out +=
      "\nthe paper's own table (its scenario, c = 30): GOSPA local 56.12, V2V 7.517, "
      "priority 48.62\n\ngates\n";
  for (const Gate& gate : evaluation.gates) {
    out += Line("  %-4s %-30s %8s  (at most %g)\n", gate.passes() ? "ok" : "MISS",
                gate.name.c_str(), Fixed(gate.value, 4).c_str(), gate.limit);
  }
  return out;
}

std::string FindingsText(const Evaluation& evaluation) {
  const ListScore& local = evaluation.headline(ListKind::kLocal);
  const ListScore& priority = evaluation.headline(ListKind::kPriority);
  std::string out;
  out += "\nLOCAL's localisation over the bound of extended vehicles of unknown size: " +
         Fixed(local.localisation_extended_ratio, 3);
  out += "\nin PRIORITY while hidden: " + UnseenText(evaluation.hidden) +
         "\nin PRIORITY while out of view: " + UnseenText(evaluation.out_of_view) +
         "\nvalidated share " + WithUnit(100.0 * evaluation.validated_share, 1, " %") +
         Line("; switches LOCAL %d, PRIORITY %d\n", local.switches, priority.switches);
  out += "ANEES (ideal 2; 95 % band)\n";
  for (const ListScore* score : {&local, &priority}) {
    out += Line("  %-8s visible ", ListTitle(score->kind)) + AneesText(score->visible) +
           "; hidden " + AneesText(score->hidden) + "; out of view " +
           AneesText(score->out_of_view) + "\n";
  }
  return out;
}

std::string TrajectoriesText(const Evaluation& evaluation) {
  const ListScore& local = evaluation.headline(ListKind::kLocal);
  const ListScore& priority = evaluation.headline(ListKind::kPriority);
  std::string out;
  out += Line("T-GOSPA per instant: LOCAL %s, PRIORITY %s%s\n",
              Fixed(local.trajectory_per_step, 3).c_str(),
              Fixed(priority.trajectory_per_step, 3).c_str(),
              local.trajectory.is_exact && priority.trajectory.is_exact ? "" : " (upper bounds)");
  out += "seconds in PRIORITY:";
  for (const auto& [id, seconds] : evaluation.hold_s) {
    out += Line(" %lld: %.1f", static_cast<long long>(id), seconds);
  }
  if (evaluation.hold_s.empty()) out += " none";
  return out;
}

std::string MissesText(const Evaluation& evaluation) {
  std::string out;
  out += "\nmissed by PRIORITY though the bound holds it (vehicle, reason, seconds, from):\n";
  for (const Miss& miss : evaluation.misses) {
    out += Line("  %lld %s%s%s %.1f s from %.1f s\n", static_cast<long long>(miss.vehicle),
                MissReasonKey(miss.reason), miss.check.empty() ? "" : " ", miss.check.c_str(),
                miss.seconds, miss.first_s);
  }
  if (evaluation.misses.empty()) out += "  none\n";
  return out;
}

}  // namespace

std::string ToJson(const Evaluation& evaluation, const Evaluation* paper) {
  Json json;
  json["cutoff_m"] = evaluation.settings.cutoff_m;
  json["order"] = evaluation.settings.order;
  json["duration_s"] = Rounded(evaluation.duration_s);
  json["lists"] = ListsJson(evaluation.cutoffs.front().own, true);
  json["hidden"] = UnseenJson(evaluation.hidden);
  json["out_of_view"] = UnseenJson(evaluation.out_of_view);
  json["behaviour"] = BehaviourJson(evaluation.behaviour);
  json["scorecard"] = ScorecardJson(evaluation.scorecards);
  json["validated_share"] = Rounded(evaluation.validated_share);
  json["hold_s"] = Json::object();
  for (const auto& [id, seconds] : evaluation.hold_s) {
    json["hold_s"][std::to_string(id)] = Rounded(seconds);
  }
  json["priority_missed"] = Json::array();
  for (const Miss& miss : evaluation.misses) {
    json["priority_missed"].push_back({{"vehicle", miss.vehicle},
                                       {"reason", MissReasonKey(miss.reason)},
                                       {"check", miss.check},
                                       {"seconds", Rounded(miss.seconds)},
                                       {"first_s", Rounded(miss.first_s)}});
  }
  json["instants"] = evaluation.headline(ListKind::kLocal).series.size();
  json["switching_penalty_m"] = evaluation.settings.switching();
  json["ideal_points"] = evaluation.log.specs.has_ideal_points;
  json["scenario"] = evaluation.log.specs.name;
  json["all_vehicles"] = ListsJson(evaluation.cutoffs.front().all, false);
  for (std::size_t k = 1; k < evaluation.cutoffs.size(); ++k) {
    json["other_cutoffs"].push_back(
        {{"cutoff_m", evaluation.cutoffs[k].cutoff_m},
         {"lists", ListsJson(evaluation.cutoffs[k].own, false)},
         {"all_vehicles", ListsJson(evaluation.cutoffs[k].all, false)}});
  }
  for (const Gate& gate : evaluation.gates) {
    json["gates"][gate.name] = {
        {"value", Rounded(gate.value)}, {"limit", gate.limit}, {"pass", gate.passes()}};
  }
  if (paper != nullptr) {
    json["paper_method"] = {{"lists", ListsJson(paper->cutoffs.front().own, false)},
                            {"all_vehicles", ListsJson(paper->cutoffs.front().all, false)}};
  }
  return json.dump(1) + "\n";
}

std::string ToTable(const Evaluation& evaluation, const Evaluation* paper) {
  std::string out;
  const ListScore& local = evaluation.headline(ListKind::kLocal);
  out += Line("%s, %.1f s, %zu instants at 20 Hz, p = 2, disc of %.0f m%s\n",
              evaluation.log.specs.name.empty() ? "run" : evaluation.log.specs.name.c_str(),
              evaluation.duration_s, local.series.size(), evaluation.settings.radius_m,
              evaluation.log.specs.has_ideal_points ? ", ideal points" : "");
  for (const CutoffScores& scores : evaluation.cutoffs) {
    AppendScores(out,
                 Line("c = %g m; LOCAL against every vehicle, V2V and PRIORITY against senders",
                      scores.cutoff_m)
                     .c_str(),
                 scores.own);
    AppendScores(out, Line("c = %g m; all lists against every vehicle", scores.cutoff_m).c_str(),
                 scores.all);
  }
  if (paper != nullptr) {
    AppendScores(out,
                 Line("the paper's association on this run, c = %g m, own scopes",
                      paper->cutoffs.front().cutoff_m)
                     .c_str(),
                 paper->cutoffs.front().own);
  }
  out += GatesTable(evaluation) + FindingsText(evaluation);
  out += BehaviourTable(evaluation.behaviour);
  out += ScorecardTable(evaluation.scorecards);
  return out + TrajectoriesText(evaluation) + MissesText(evaluation);
}

}  // namespace v2vouch::evaluation
