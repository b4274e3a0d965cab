// SPDX-License-Identifier: Apache-2.0
#include "sim/report/report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "daemon/rim/io/durable_file.h"
#include "sim/plot/report_style.h"
#include "sim/plot/svg.h"
#include "sim/report/behaviour_text.h"
#include "sim/report/birds_eye.h"
#include "sim/report/moments.h"
#include "sim/report/report_tables.h"
#include "sim/report/timeline.h"

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

// RFC 4648, section 4.
std::string Base64(const std::vector<std::uint8_t>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (i + k < bytes.size() ? bytes[i + k] : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const bool is_padding = i + k > bytes.size();
      out.push_back(is_padding ? '=' : kDigits[group >> (18U - 6U * k) & 63U]);
    }
  }
  return out;
}

std::string Card(const std::string& title, const std::string& text, const std::string& body) {
  return "<section class=\"card\">\n<h2>" + title + "</h2>\n" +
         (text.empty() ? "" : "<p class=\"note\">" + text + "</p>\n") + body + "</section>\n";
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

std::string Pictures(const Evaluation& evaluation, std::optional<std::size_t> critical) {
  const std::vector<Moment> moments = ChooseMoments(evaluation, critical);
  const View view = ChooseView(evaluation, moments, critical);
  std::string out = BirdsEyeLegend() + "<div class=\"pictures\">\n";
  for (std::size_t k = 0; k < moments.size(); ++k) {
    out += BirdsEye(evaluation, moments[k], view, critical, std::to_string(k));
  }
  return out + "</div>\n";
}

std::string CameraPictures(const std::vector<ReportPicture>& pictures) {
  std::string out;
  for (const ReportPicture& picture : pictures) {
    out += "<figure><img style=\"max-width:100%\" alt=\"" + Escape(picture.caption) +
           "\" src=\"data:image/jpeg;base64," + Base64(picture.jpeg) + "\"><figcaption>" +
           Escape(picture.caption) + "</figcaption></figure>\n";
  }
  return out;
}

}  // namespace

std::string ReportHtml(const Evaluation& evaluation, const Evaluation* paper,
                       const std::vector<ReportPicture>& pictures) {
  const auto critical = CriticalVehicle(evaluation);
  const std::string name =
      evaluation.log.specs.name.empty() ? "recorded run" : evaluation.log.specs.name;
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>V2Vouch: " +
      Escape(name) + "</title>\n<style>" + ReportStyle() + "</style>\n</head>\n<body><main>\n";
  out += "<h1>V2Vouch: " + Escape(name) + "</h1>\n<p class=\"sub\">" +
         Number(evaluation.duration_s, 1) + " s, " +
         std::to_string(evaluation.headline(ListKind::kLocal).series.size()) +
         " instants at 20 Hz, " +
         (evaluation.log.specs.has_ideal_points ? "ideal point targets" : "extended vehicles") +
         ", disc of " + Number(evaluation.settings.radius_m) + " m round the ego</p>\n";
  out += Card("Gates", "", GatesHtml(evaluation));
  out += Card(
      "The scene",
      "From above, ego heading up. Moments are chosen around the V2V vehicle that no sensor sees "
      "for longest after having been seen.",
      Pictures(evaluation, critical));
  if (!pictures.empty()) {
    out += Card("Through the camera",
                "White: what the network or the smart camera saw. Green: LOCAL, magenta: PRIORITY, "
                "as boxes standing on a flat road.",
                CameraPictures(pictures));
  }
  out += Card("Beside the paper",
              "Means over the run; missed, false and switching errors are roots, as in the paper. "
              "The paper's row is its own simulation, whose unit and truth set are not stated; the "
              "other rows are this run.",
              ComparisonHtml(evaluation, paper));
  out += TimeCards(evaluation, critical);
  if (critical) {
    out += Card("Vehicle " + std::to_string(evaluation.log.truth.objects[*critical].id) +
                    ": position error",
                "Gaps: the list does not hold it.", CriticalError(evaluation, *critical));
  }
  out += Card("Who is held when", "", Timeline(evaluation, 24));
  out += Card("Details", "", DetailsHtml(evaluation));
  out +=
      Card("Behaviour",
           "Heading errors are those of tracks older than a second; a flip is a track that turns "
           "from below 90&deg; of error to above. Visibility: the lists' flag against TRUTH; "
           "\"visible\" is also said where it cannot be told. A look is a sensor frame with a "
           "detection probability of at least one half.",
           BehaviourHtml(evaluation.behaviour));
  out += Card("How to read this", "", DefinitionsHtml(evaluation));
  return out + "</main></body></html>\n";
}

std::string WriteReport(const std::string& folder, const Evaluation& evaluation,
                        const Evaluation* paper, const std::vector<ReportPicture>& pictures,
                        std::string& error) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  const auto path = std::filesystem::path(folder) / "index.html";
  const bool is_written =
      ReplaceFile(path.string(), ReportHtml(evaluation, paper, pictures), error);
  return is_written ? path.string() : "";
}

}  // namespace v2vouch::evaluation
