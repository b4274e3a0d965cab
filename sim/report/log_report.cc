// SPDX-License-Identifier: Apache-2.0
#include "sim/report/log_report.h"

#include <algorithm>
#include <array>

#include "sim/plot/report_style.h"
#include "sim/plot/svg.h"
#include "sim/report/page.h"
#include "sim/report/story.h"
#include "sim/report/trust_strip.h"

namespace v2vouch::evaluation {
namespace {

constexpr std::array kColours = {"#0072b2", "#e69f00", "#009e73", "#cc79a7",
                                 "#56b4e9", "#d55e00", "#7f7f7f", "#2d333b"};

bool IsInput(const std::string& channel) {
  return channel.starts_with("RADAR_") || channel.starts_with("CAMERA_") ||
         channel.starts_with("OBJECTS_") || channel.starts_with("EGO_") || channel == "BSM";
}

std::string VerdictsHtml(const RunLog& log, Timestamp begin) {
  constexpr int kMost = 20;
  std::string out =
      "<table class=\"text\"><tr><th>at</th><th>sender</th><th>check</th><th></th></tr>\n";
  int rows = 0;
  for (const VerdictReport& report : log.reports) {
    if (++rows > kMost) continue;
    out += "<tr><td>" + Number(ToSeconds(report.received - begin), 1) + " s</td><td>" +
           SenderText(report.sender) + "</td><td>" + Escape(report.check) + "</td><td>" +
           (report.is_accusation ? "accused" : "withdrawn") + "</td></tr>\n";
  }
  if (rows == 0) return "<p>none</p>\n";
  out += "</table>\n";
  if (rows > kMost) out += "<p>and " + std::to_string(rows - kMost) + " more</p>\n";
  return out;
}

}  // namespace

std::string RatesHtml(const LogFacts& facts) {
  Plot plot;
  plot.id = "rates";
  plot.y_label = "messages per second";
  std::size_t seconds = 1;
  std::size_t next = 0;
  std::string left_out;
  for (const LogFacts::Channel& channel : facts.channels) {
    if (!IsInput(channel.name)) continue;
    seconds = std::max(seconds, channel.per_second.size());
    if (next >= kColours.size()) {
      left_out += (left_out.empty() ? "" : ", ") + Escape(channel.name);
      continue;
    }
    PlotSeries line{channel.name, kColours[next++], {}, false, 1.6};
    // The last second is not full.
    for (std::size_t s = 0; s + 1 < channel.per_second.size(); ++s) {
      line.points.emplace_back(static_cast<double>(s) + 0.5, channel.per_second[s]);
    }
    plot.series.push_back(std::move(line));
  }
  if (plot.series.empty()) return "<p>none</p>\n";
  plot.x_to = static_cast<double>(seconds);
  return Draw(plot) +
         (left_out.empty() ? "" : "<p class=\"note\">Not drawn: " + left_out + "</p>\n");
}

std::string RefusalsHtml(const LogFacts& facts) {
  if (!facts.has_status) return "<p>The log holds no V2VOUCH_STATUS.</p>\n";
  if (facts.refusals.empty()) return "<p>none</p>\n";
  std::string out =
      "<table "
      "class=\"text\"><tr><th>channel</th><th>reason</th><th>field</th><th>count</th></tr>\n";
  for (const LogFacts::Refusal& refusal : facts.refusals) {
    out += "<tr><td>" + Escape(refusal.channel) + "</td><td>" + Escape(refusal.reason) +
           "</td><td>" + Escape(refusal.field) + "</td><td>" + std::to_string(refusal.count) +
           "</td></tr>\n";
  }
  return out + "</table>\n";
}

std::string LogReportHtml(const RunLog& log, const LogFacts& facts,
                          const std::vector<ReportPicture>& pictures, const std::string& clip) {
  Timestamp begin = facts.begin;
  for (const ListKind kind : kLists) {
    // Lists bear message time; the recorder's clock may be another.
    if (!log.lists[Index(kind)].empty()) {
      begin = log.lists[Index(ListKind::kLocal)].empty()
                  ? log.lists[Index(kind)].front().stamp
                  : log.lists[Index(ListKind::kLocal)].front().stamp;
      break;
    }
  }
  const double end_s = std::max(1.0, log.log_seconds);
  std::string out =
      PageHead("recorded drive", Number(log.log_seconds, 1) + " s, " + std::to_string(log.events) +
                                     " events, no truth");
  out += Card("What happened", "", StoryHtml(StoryWithoutTruth(log)));
  if (!clip.empty()) out += Card("Play it", kClipNote, clip);
  if (!pictures.empty()) out += Card("Through the camera", kCameraNote, PicturesHtml(pictures));
  out +=
      Card("PRIORITY: held when", "Pale red and violet: kept by its BSMs while no sensor sees it.",
           TrackStrips(log, ListKind::kPriority, begin, end_s, 20));
  out += Card("LOCAL: held when", "", TrackStrips(log, ListKind::kLocal, begin, end_s, 24));
  out += Card("Trust over time", "Each sender's state in the V2V list; a black mark is a verdict.",
              TrustStrips(log, {}, begin, end_s, 20));
  out += Card("Inputs over time", "", RatesHtml(facts));
  out += Card("Verdicts", "", VerdictsHtml(log, begin));
  out += Card("Refused", "As the daemon counted at the end of the log.", RefusalsHtml(facts));
  out += Card("Lists", "", "<pre>" + Escape(ListSummary(log)) + "</pre>\n");
  return out + PageFoot();
}

}  // namespace v2vouch::evaluation
