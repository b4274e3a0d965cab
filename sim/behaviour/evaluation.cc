// SPDX-License-Identifier: Apache-2.0
#include "sim/behaviour/evaluation.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::evaluation {
namespace {

// Gates of the headline cutoff.
constexpr double kPointLocalisation = 1.25;    // RMS over bound, ideal point targets
constexpr double kExtendedLocalisation = 2.5;  // ... extended cars of unknown size
constexpr double kExcessMissedShare = 0.03;
constexpr double kLocalFalsePerInstant = 0.02;

void ScorePriorityExtras(Evaluation& evaluation) {
  const Truth& truth = evaluation.log.truth;
  const ListScore& priority = evaluation.headline(ListKind::kPriority);
  const double period = evaluation.settings.period_s;
  for (const TruthObject& object : truth.objects) {
    if (object.is_vehicle() && object.has_v2v) evaluation.hold_s[object.id] = 0.0;
  }
  const auto error_of = [&](Sighting sighting) -> UnseenError& {
    return sighting == Sighting::kHidden ? evaluation.hidden : evaluation.out_of_view;
  };
  double hidden_sum = 0.0, out_of_view_sum = 0.0;
  for (const MatchedPair& pair : priority.pairs) {
    evaluation.hold_s[truth.objects[pair.object].id] += period;
    if (pair.sighting == Sighting::kVisible) continue;
    UnseenError& error = error_of(pair.sighting);
    (pair.sighting == Sighting::kHidden ? hidden_sum : out_of_view_sum) +=
        pair.error_m * pair.error_m;
    error.max_m = std::fmax(error.max_m, pair.error_m);  // Of NaN and a number the number.
    error.seconds += period;
  }
  const auto rms = [period](double sum, double seconds) {
    return seconds > 0.0 ? std::sqrt(sum * period / seconds) : kNoValue;
  };
  evaluation.hidden.rms_m = rms(hidden_sum, evaluation.hidden.seconds);
  evaluation.out_of_view.rms_m = rms(out_of_view_sum, evaluation.out_of_view.seconds);
  for (const InstantScore& now : priority.series) {
    const Timestamp t = evaluation.grid[now.instant];
    const auto ego = truth.ego.At(t);
    const auto X_WB = truth.EgoPose(t);
    for (std::size_t o = 0; ego && X_WB && o < truth.objects.size(); ++o) {
      const TruthObject& object = truth.objects[o];
      const TruthSample* sample = object.motion.InForce(t);
      if (sample == nullptr || !sample->is_hidden || !object.has_v2v) continue;
      const PlanarMotion motion = *object.motion.At(t);
      if ((motion.position() - ego->position()).norm() > evaluation.settings.radius_m) continue;
      if (evaluation.bound->At(ListKind::kPriority, o, now.instant).is_held) {
        error_of(TrueSighting(*sample, motion, *X_WB, evaluation.log.specs)).possible_seconds +=
            period;
      }
    }
  }
  evaluation.validated_share = 1.0 - priority.excess_missed_share;
}

void SetGates(Evaluation& evaluation) {
  const double localisation =
      evaluation.log.specs.has_ideal_points ? kPointLocalisation : kExtendedLocalisation;
  for (const ListKind kind : {ListKind::kLocal, ListKind::kPriority}) {
    const ListScore& score = evaluation.headline(kind);
    const std::string key = ListKey(kind);
    // A list that holds nothing is not thereby accurate, unless there was nothing to hold.
    const bool may_be_none =
        score.has_lists &&
        (!score.pairs.empty() || score.bound_missed_seconds >= score.vehicle_seconds);
    evaluation.gates.push_back(
        {key + "_localisation_ratio", score.localisation_ratio, localisation, may_be_none});
    evaluation.gates.push_back({key + "_excess_missed_share", score.excess_missed_share,
                                kExcessMissedShare, score.has_lists});
    evaluation.gates.push_back({key + "_false_per_instant", score.false_per_instant(),
                                kind == ListKind::kLocal ? kLocalFalsePerInstant : 0.0});
  }
}

}  // namespace

const CutoffScores& Evaluation::at_cutoff(double cutoff_m) const {
  for (const CutoffScores& scores : cutoffs) {
    if (scores.cutoff_m == cutoff_m) return scores;
  }
  return cutoffs.front();
}

std::unique_ptr<Evaluation> Evaluate(RunLog log, const ScoringSettings& settings) {
  auto evaluation = std::make_unique<Evaluation>();
  evaluation->log = std::move(log);
  evaluation->settings = settings;
  const Truth& truth = evaluation->log.truth;
  evaluation->grid = MakeGrid(truth, settings);
  evaluation->duration_s = ToSeconds(truth.end() - truth.begin());
  evaluation->bound = std::make_unique<Bound>(evaluation->log, evaluation->grid);

  std::vector<double> cutoffs = {settings.cutoff_m};
  for (const double cutoff_m : {10.0, 30.0}) {
    if (cutoff_m != settings.cutoff_m) cutoffs.push_back(cutoff_m);
  }
  for (const double cutoff_m : cutoffs) {
    ScoringSettings at = settings;
    at.cutoff_m = cutoff_m;
    if (cutoff_m != settings.cutoff_m) at.switching_m = 0.0;
    CutoffScores scores{cutoff_m, {}, {}};
    const bool is_headline = cutoff_m == settings.cutoff_m;
    for (const ListKind kind : kLists) {
      scores.own.push_back(ScoreList(evaluation->log, evaluation->grid, *evaluation->bound, kind,
                                     Against::kOwnScope, at, is_headline));
      scores.all.push_back(ScoreList(evaluation->log, evaluation->grid, *evaluation->bound, kind,
                                     Against::kAllVehicles, at, false));
    }
    evaluation->cutoffs.push_back(std::move(scores));
  }
  ScorePriorityExtras(*evaluation);
  const auto behaviour_of = [&](ListKind kind) {
    return JudgeList(evaluation->log, evaluation->grid, *evaluation->bound,
                     evaluation->headline(kind), settings);
  };
  evaluation->behaviour.local = behaviour_of(ListKind::kLocal);
  evaluation->behaviour.priority = behaviour_of(ListKind::kPriority);
  evaluation->behaviour.confirmation = JudgeConfirmation(evaluation->log, settings);
  ScorecardSettings card;
  card.cutoff_m = settings.cutoff_m;
  card.radius_m = settings.radius_m;
  card.skip_s = settings.skip_s;
  evaluation->scorecards = JudgeScorecards(evaluation->log, card);
  evaluation->misses = ExplainMisses(
      evaluation->log, evaluation->grid, *evaluation->bound, evaluation->headline(ListKind::kLocal),
      evaluation->headline(ListKind::kPriority), evaluation->settings);
  SetGates(*evaluation);
  return evaluation;
}

}  // namespace v2vouch::evaluation
