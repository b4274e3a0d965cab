// SPDX-License-Identifier: Apache-2.0
#include "sim/report/report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "daemon/rim/io/durable_file.h"
#include "sim/plot/svg.h"
#include "sim/report/behaviour_text.h"
#include "sim/report/birds_eye.h"
#include "sim/report/liar_section.h"
#include "sim/report/log_report.h"
#include "sim/report/moments.h"
#include "sim/report/page.h"
#include "sim/report/report_tables.h"
#include "sim/report/timeline.h"
#include "sim/report/trust_strip.h"

namespace v2vouch::evaluation {
namespace {

const char* ColourOf(ListKind kind) {
  constexpr std::array kColours = {colour::kLocal, colour::kV2v, colour::kPriority};
  return kColours[Index(kind)];
}

std::vector<PlotBand> BandsOf(const Evaluation& evaluation, std::optional<std::size_t> critical) {
  std::vector<PlotBand> bands;
  if (!critical) return bands;
  const std::string name =
      "vehicle " + std::to_string(evaluation.log.truth.objects[*critical].id) + " ";
  for (const auto& [sighting, fill] : {std::pair(Sighting::kHidden, colour::kHidden),
                                       std::pair(Sighting::kOutOfView, colour::kOutOfView)}) {
    for (const Interval& unseen : UnseenIntervals(evaluation, *critical, true, sighting)) {
      bands.push_back({unseen.from_s, unseen.to_s, fill, name + SightingName(sighting)});
    }
  }
  return bands;
}

Plot PlotOver(const Evaluation& evaluation, std::optional<std::size_t> critical, std::string id,
              std::string y_label) {
  Plot plot;
  plot.id = std::move(id);
  plot.y_label = std::move(y_label);
  plot.x_to = std::max(evaluation.settings.period_s, evaluation.duration_s);
  plot.bands = BandsOf(evaluation, critical);
  return plot;
}

/// The paper's figures 4 and 5: one value per list over time.
template <class Value>
std::string OverTime(const Evaluation& evaluation, const std::vector<ListScore>& scores,
                     std::optional<std::size_t> critical, const std::string& id,
                     const std::string& y_label, double y_least_top, bool with_bound,
                     const Value& value) {
  Plot plot = PlotOver(evaluation, critical, id, y_label);
  plot.y_least_top = y_least_top;
  for (const ListScore& score : scores) {
    PlotSeries line{ListTitle(score.kind), ColourOf(score.kind), {}, false, 1.8};
    PlotSeries bound{
        std::string("bound ") + ListTitle(score.kind), ColourOf(score.kind), {}, true, 1.2};
    for (const InstantScore& now : score.series) {
      line.points.emplace_back(now.t_s, value(now));
      bound.points.emplace_back(now.t_s, now.bound_gospa);
    }
    plot.series.push_back(std::move(line));
    if (with_bound && score.kind != ListKind::kV2v) plot.series.push_back(std::move(bound));
  }
  return Draw(plot);
}

/// Position error of the critical vehicle in each list, with the bound of the fused one.
std::string CriticalError(const Evaluation& evaluation, std::size_t critical) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Plot plot = PlotOver(evaluation, critical, "critical", "position error [m]");
  for (const ListScore& score : evaluation.cutoffs.front().own) {
    PlotSeries line{ListTitle(score.kind), ColourOf(score.kind), {}, false, 1.6};
    for (const InstantScore& now : score.series) line.points.emplace_back(now.t_s, kNone);
    for (const MatchedPair& pair : score.pairs) {
      if (pair.object != critical || score.series.empty()) continue;
      line.points[pair.instant - score.series.front().instant].y() = pair.error_m;
    }
    plot.series.push_back(std::move(line));
  }
  PlotSeries bound{"bound PRIORITY (RMS)", colour::kInk, {}, true, 1.4};
  for (const InstantScore& now : evaluation.headline(ListKind::kPriority).series) {
    const BoundCell& cell = evaluation.bound->At(ListKind::kPriority, critical, now.instant);
    bound.points.emplace_back(now.t_s, cell.is_held ? std::sqrt(cell.variance_m2) : kNone);
  }
  plot.series.push_back(std::move(bound));
  return Draw(plot);
}

std::string TimeCards(const Evaluation& evaluation, std::optional<std::size_t> critical) {
  const auto gospa = [](const InstantScore& now) { return now.gospa; };
  const auto false_error = [](const InstantScore& now) { return std::sqrt(now.false_pow); };
  const double c = evaluation.settings.cutoff_m;
  const auto& own = evaluation.cutoffs.front().own;
  std::string out = Card(
      "GOSPA over time, c = " + Number(c) + " m",
      "LOCAL against every vehicle, V2V and PRIORITY against vehicles that send BSMs, within " +
          Number(evaluation.settings.radius_m) +
          " m of the ego. Dashed: the least any list could have, from this run's truth.",
      OverTime(evaluation, own, critical, "gospa", "GOSPA [m]", 0.0, true, gospa));
  out += Card("False-track error over time, c = " + Number(c) + " m", "",
              OverTime(evaluation, own, critical, "false", "false-track error [m]",
                       c / std::sqrt(2.0) * 1.05, false, false_error));
  const auto& wide = evaluation.at_cutoff(30.0).all;
  out += Card("As the paper plots it: c = 30 m, every list against every vehicle",
              "Its figure 4 (GOSPA) and figure 5 (false tracks). A vehicle without V2V counts as "
              "missed in V2V and PRIORITY here.",
              OverTime(evaluation, wide, critical, "gospa30", "GOSPA [m]", 0.0, false, gospa) +
                  OverTime(evaluation, wide, critical, "false30", "false-track error [m]",
                           30.0 / std::sqrt(2.0) * 1.05, false, false_error));
  return out;
}

// Where a liar's claim is nearest to the ego; nothing where a picture of `shown` has one already.
std::optional<Moment> LiarMoment(const Evaluation& evaluation, const LiarFacts* liars,
                                 const std::vector<Moment>& shown) {
  if (liars == nullptr || !liars->has_liar()) return std::nullopt;
  std::optional<Moment> best;
  double nearest_m = 60.0;
  const Truth& truth = evaluation.log.truth;
  for (const BsmTruth& bsm : liars->log.bsm_truths) {
    if (!bsm.is_attack) continue;
    const auto ego = truth.ego.At(bsm.stamp);
    const double t_s = ToSeconds(bsm.stamp - evaluation.grid.front());
    const double k = std::round(t_s / evaluation.settings.period_s);
    if (!ego || k < 0.0 || k >= static_cast<double>(evaluation.grid.size())) continue;
    const double distance_m = (bsm.claimed.p_W - ego->position()).norm();
    if (distance_m < 40.0 && std::ranges::any_of(shown, [&](const Moment& moment) {
          return std::abs(moment.t_s - t_s) < 0.5;
        })) {
      return std::nullopt;
    }
    if (distance_m < nearest_m) {
      nearest_m = distance_m;
      best = Moment{static_cast<std::size_t>(k), t_s, "false claim of " + SenderText(bsm.sender)};
    }
  }
  return best;
}

std::string Pictures(const Evaluation& evaluation, std::optional<std::size_t> critical,
                     const LiarFacts* liars) {
  std::vector<Moment> moments = ChooseMoments(evaluation, critical);
  if (const auto moment = LiarMoment(evaluation, liars, moments)) moments.push_back(*moment);
  const View view = ChooseView(evaluation, moments, critical);
  std::string out = BirdsEyeLegend() + "<div class=\"pictures\">\n";
  for (std::size_t k = 0; k < moments.size(); ++k) {
    out += BirdsEye(evaluation, moments[k], view, critical, std::to_string(k),
                    liars == nullptr ? nullptr : &liars->log);
  }
  return out + "</div>\n";
}

}  // namespace

std::optional<Timestamp> MomentWorthSeeing(const Evaluation& evaluation) {
  if (evaluation.grid.empty()) return std::nullopt;
  return evaluation.grid[ChooseMoments(evaluation, CriticalVehicle(evaluation))[1].instant];
}

std::string ReportHtml(const Evaluation& evaluation, const Evaluation* paper,
                       const std::vector<ReportPicture>& pictures, const LiarFacts* liars,
                       const LogFacts* facts, const std::string& clip) {
  const auto critical = CriticalVehicle(evaluation);
  const std::string name =
      evaluation.log.specs.name.empty() ? "recorded run" : evaluation.log.specs.name;
  std::string out = PageHead(
      name,
      Number(evaluation.duration_s, 1) + " s, " +
          std::to_string(evaluation.headline(ListKind::kLocal).series.size()) +
          " instants at 20 Hz, " +
          (evaluation.log.specs.has_ideal_points ? "ideal point targets" : "extended vehicles") +
          ", disc of " + Number(evaluation.settings.radius_m) + " m round the ego");
  out += Card("What happened", "", StoryHtml(Story(evaluation, liars)));
  if (!clip.empty()) out += Card("Play it", kClipNote, clip);
  out += Card(
      "The scene",
      "From above, ego heading up. Moments are chosen around the V2V vehicle that no sensor sees "
      "for longest after having been seen.",
      Pictures(evaluation, critical, liars));
  if (liars != nullptr && liars->has_liar()) {
    out += Card("The liar", "A red cross in the pictures above is a false claim.",
                LiarSection(evaluation, *liars));
  }
  if (!pictures.empty()) out += Card("Through the camera", kCameraNote, PicturesHtml(pictures));
  out += Card("Who is held when", "", Timeline(evaluation, 24));
  out += Card("Trust over time", "Each sender's state in the V2V list; a black mark is a verdict.",
              TrustStrips(evaluation.log, {}, evaluation.log.truth.begin(),
                          std::max(1.0, evaluation.duration_s), 16));
  if (critical) {
    out += Card("Vehicle " + std::to_string(evaluation.log.truth.objects[*critical].id) +
                    ": position error",
                "Gaps: the list does not hold it.", CriticalError(evaluation, *critical));
  }
  out += TimeCards(evaluation, critical);
  if (facts != nullptr) out += Card("Inputs over time", "", RatesHtml(*facts));
  out += Card("Beside the paper",
              "Means over the run; missed, false and switching errors are roots, as in the paper. "
              "The paper's row is its own simulation, whose unit and truth set are not stated; the "
              "other rows are this run.",
              ComparisonHtml(evaluation, paper));
  out += Card("Details", "", DetailsHtml(evaluation));
  out +=
      Card("Behaviour",
           "Heading errors are those of tracks older than a second; a flip is a track that turns "
           "from below 90&deg; of error to above. Visibility: the lists' flag against TRUTH; "
           "\"visible\" is also said where it cannot be told. A look is a sensor frame with a "
           "detection probability of at least one half.",
           BehaviourHtml(evaluation.behaviour));
  if (facts != nullptr) {
    out += Card("Refused", "As the daemon counted at the end of the log.", RefusalsHtml(*facts));
  }
  out += Card("Gates",
              "Three figures that this project holds its lists to, on its own scenarios; a missed "
              "gate is work to do, not a fault of this log. <b>Localisation / bound</b>: the error "
              "of visible vehicles over the least that any tracker could have with these sensors "
              "(1 = perfect). <b>Missed beyond the unavoidable</b>: time in which a vehicle could "
              "have been listed and was not. <b>False tracks</b>: listed where nothing is, per "
              "instant.",
              GatesHtml(evaluation));
  out += Card("How to read this", "", DefinitionsHtml(evaluation));
  return out + PageFoot();
}

std::string WritePage(const std::string& folder, const std::string& html, std::string& error) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  const auto path = std::filesystem::path(folder) / "index.html";
  return ReplaceFile(path.string(), html, error) ? path.string() : "";
}

}  // namespace v2vouch::evaluation
