// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "calibration/programs/calibration_run.h"
#include "daemon/rim/io/durable_file.h"
#include "sim/plot/report_style.h"
#include "sim/plot/svg.h"

namespace v2vouch {
namespace {

using evaluation::Escape;
using evaluation::Fixed;
using evaluation::NiceStep;
using evaluation::Number;
using evaluation::Svg;

constexpr double kWidth = 520.0;
constexpr double kHeight = 240.0;
constexpr double kLeft = 58.0;
constexpr double kRight = 14.0;
constexpr double kTop = 14.0;
constexpr double kBottom = 40.0;

// Axes of one picture: data to pixels.
class Axes {
 public:
  Axes(double x_from, double x_to, double y_from, double y_to, const std::string& x_label,
       const std::string& y_label)
      : svg_(kWidth, kHeight), x_from_(x_from), x_to_(x_to), y_from_(y_from), y_to_(y_to) {
    const std::string grid = std::string("stroke=\"") + evaluation::colour::kGrid + "\"";
    const std::string ink =
        std::string("fill=\"") + evaluation::colour::kMuted + "\" font-size=\"11\"";
    for (double x = First(x_from, Step(x_from, x_to)); x <= x_to + 1e-9; x += Step(x_from, x_to)) {
      svg_.Line(X(x), kTop, X(x), kHeight - kBottom, grid);
      svg_.Text(X(x), kHeight - kBottom + 14.0, Number(x, 2), ink + " text-anchor=\"middle\"");
    }
    for (double y = First(y_from, Step(y_from, y_to)); y <= y_to + 1e-9; y += Step(y_from, y_to)) {
      svg_.Line(kLeft, Y(y), kWidth - kRight, Y(y), grid);
      svg_.Text(kLeft - 6.0, Y(y) + 4.0, Number(y, 3), ink + " text-anchor=\"end\"");
    }
    svg_.Text(0.5 * (kLeft + kWidth - kRight), kHeight - 6.0, x_label,
              ink + " text-anchor=\"middle\"");
    svg_.Text(14.0, 0.5 * (kTop + kHeight - kBottom), y_label,
              ink + " text-anchor=\"middle\" transform=\"rotate(-90 14 " +
                  Number(0.5 * (kTop + kHeight - kBottom)) + ")\"");
  }
  [[nodiscard]] double X(double x) const {
    return kLeft + (kWidth - kLeft - kRight) * (x - x_from_) / (x_to_ - x_from_);
  }
  [[nodiscard]] double Y(double y) const {
    const double share = std::clamp((y - y_from_) / (y_to_ - y_from_), -0.02, 1.02);
    return kHeight - kBottom - (kHeight - kTop - kBottom) * share;
  }
  Svg& svg() { return svg_; }

 private:
  static double Step(double from, double to) { return NiceStep(to - from, 6); }
  static double First(double from, double step) { return std::ceil(from / step - 1e-9) * step; }

  Svg svg_;
  double x_from_, x_to_, y_from_, y_to_;
};

std::string Stroke(const char* colour, double width) {
  return std::string("fill=\"none\" stroke=\"") + colour + "\" stroke-width=\"" + Number(width) +
         "\"";
}

// Means with the scatter of one residual around them; `scale` of the bars against the axis.
std::string DrawBins(const std::vector<ResidualPictures::Bin>& bins, const std::string& x_label,
                     const std::string& y_label) {
  if (bins.size() < 2) return "<p class=\"muted\">too few residuals to draw</p>";
  double most = 0.0;
  for (const auto& bin : bins) most = std::max(most, std::abs(bin.mean) + bin.std);
  const double step = 0.5 * (bins[1].at - bins[0].at);
  Axes axes(bins.front().at - step, bins.back().at + step, -1.1 * most, 1.1 * most, x_label,
            y_label);
  axes.svg().Line(kLeft, axes.Y(0.0), kWidth - kRight, axes.Y(0.0),
                  Stroke(evaluation::colour::kMuted, 1.0));
  std::vector<Eigen::Vector2d> line;
  for (const auto& bin : bins) {
    axes.svg().Line(axes.X(bin.at), axes.Y(bin.mean - bin.std), axes.X(bin.at),
                    axes.Y(bin.mean + bin.std), Stroke("#a9c4e4", 5.0));
    line.emplace_back(axes.X(bin.at), axes.Y(bin.mean));
  }
  axes.svg().Polyline(line, Stroke(evaluation::colour::kLocal, 1.8));
  for (const auto& point : line) {
    axes.svg().Circle(point.x(), point.y(), 2.6,
                      std::string("fill=\"") + evaluation::colour::kLocal + "\"");
  }
  return axes.svg().Finish();
}

std::string DrawPixels(const ResidualPictures::Camera& camera) {
  if (camera.pixels.size() < 10) return "<p class=\"muted\">too few boxes to draw</p>";
  const double scale = (kWidth - 2.0) / camera.width_px;
  Svg svg(kWidth, scale * camera.height_px + 2.0);
  svg.Rect(1.0, 1.0, scale * camera.width_px, scale * camera.height_px,
           std::string("fill=\"#fafbfc\" stroke=\"") + evaluation::colour::kGrid + "\"");
  constexpr double kMagnified = 10.0;
  for (const auto& pixel : camera.pixels) {
    const double x = 1.0 + scale * pixel.u_px;
    const double y = 1.0 + scale * pixel.v_px;
    svg.Line(x, y, x + scale * kMagnified * pixel.du_px, y + scale * kMagnified * pixel.dv_px,
             std::string("stroke=\"") + evaluation::colour::kV2v +
                 "\" stroke-width=\"0.8\" stroke-opacity=\"0.6\"");
  }
  return svg.Finish();
}

std::string DrawRemotes(const std::vector<RemoteSolution>& remotes, int axis) {
  static const char* const kColours[] = {"#2b6cb0", "#d9822b", "#17855a", "#8e44ad",
                                         "#c0392b", "#7b8490", "#0f8b8d", "#b8860b"};
  double end = 1.0;
  double most = 1.0;
  for (const RemoteSolution& s : remotes) {
    for (const auto& block : s.blocks) {
      end = std::max(end, block.time_s);
      most = std::max(most, std::abs(block.mean_en[axis]));
    }
  }
  Axes axes(0.0, end, -1.1 * most, 1.1 * most, "time since first confirmed [s]",
            axis == 0 ? "claimed minus seen, east [m]" : "north [m]");
  std::size_t n = 0;
  for (const RemoteSolution& s : remotes) {
    const char* colour = kColours[n++ % std::size(kColours)];
    for (const auto& block : s.blocks) {
      axes.svg().Circle(axes.X(block.time_s), axes.Y(block.mean_en[axis]), 1.6,
                        std::string("fill=\"") + colour + "\" fill-opacity=\"0.7\"");
    }
    if (s.blocks.empty() || s.verdict == CalibrationVerdict::kPrior) continue;
    axes.svg().Line(axes.X(0.0), axes.Y(s.bias_en[axis]), axes.X(s.blocks.back().time_s),
                    axes.Y(s.bias_en[axis]), Stroke(colour, 1.2));
  }
  return axes.svg().Finish();
}

std::string Cell(const std::string& text) { return "<td>" + text + "</td>"; }

std::string ParameterTable(const ExtrinsicsResult& result) {
  std::string html =
      "<table><tr><th>parameter</th><th>value</th><th>std</th><th>prior</th><th>prior std</th>"
      "<th>verdict</th><th>bound</th><th>blocks scatter</th><th>whose noise</th>"
      "<th>what would help</th></tr>";
  for (const MountingEstimate& p : result.parameters) {
    std::string shares;
    for (std::size_t i = 0; i < p.shares.size() && i < 3; ++i) {
      shares += (i > 0 ? ", " : "") + Escape(p.shares[i].first) + " " +
                Number(100.0 * p.shares[i].second, 0) + "&nbsp;%";
    }
    const int digits = p.prior_std < 0.01 ? 6 : 4;
    html += "<tr>" + Cell(Escape(p.name)) + Cell(Fixed(p.value, digits)) +
            Cell(Fixed(p.std, digits)) + Cell(Fixed(p.prior, digits)) +
            Cell(Number(p.prior_std, digits)) + Cell(VerdictName(p.verdict)) +
            Cell(Fixed(p.crlb, digits)) + Cell(Fixed(p.block_std, digits)) + Cell(shares) +
            Cell(Escape(p.hint)) + "</tr>";
  }
  return html + "</table>";
}

std::string GroupTable(const ExtrinsicsResult& result) {
  std::string html =
      "<table><tr><th>measurements</th><th>equations</th><th>mean square</th>"
      "<th>without outliers</th>"
      "<th>correlation</th></tr>";
  for (const GroupFit& group : result.groups) {
    html += "<tr>" + Cell(Escape(group.name)) + Cell(std::to_string(group.equations)) +
            Cell(Fixed(group.chi_square_per_equation, 3)) +
            Cell(Fixed(group.robust_chi_square, 3)) + Cell(Fixed(group.inflation, 2)) + "</tr>";
  }
  return html + "</table>";
}

std::string RemoteTable(const std::vector<RemoteSolution>& remotes) {
  std::string html =
      "<table><tr><th>sender</th><th>verdict</th><th>east [m]</th><th>north [m]</th>"
      "<th>latency [ms]</th><th>offset [m]</th><th>pairs</th><th>seconds</th><th>why</th></tr>";
  const auto plus_minus = [](double value, double std, int digits) {
    return Fixed(value, digits) + " &plusmn; " + Fixed(std, digits);
  };
  for (const RemoteSolution& s : remotes) {
    char id[16];
    std::snprintf(id, sizeof id, "%08x", s.sender);
    html += "<tr>" + Cell(id) + Cell(VerdictName(s.verdict)) +
            Cell(plus_minus(s.bias_en.x(), std::sqrt(s.bias_covariance(0, 0)), 2)) +
            Cell(plus_minus(s.bias_en.y(), std::sqrt(s.bias_covariance(1, 1)), 2)) +
            Cell(plus_minus(1e3 * s.latency_s, 1e3 * s.latency_std_s, 0)) +
            Cell(plus_minus(s.offset_m, s.offset_std_m, 2)) + Cell(std::to_string(s.pairs)) +
            Cell(Number(s.span_s, 0)) + Cell(Escape(s.reason)) + "</tr>";
  }
  return html + "</table>";
}

// Verdict, logs, how the drive was, and what is wrong.
std::string HeadText(const CalibrationRun& run) {
  const ExtrinsicsResult& result = run.extrinsics;
  std::string html;
  html += std::string("<h1>Calibration: ") + (result.accepted ? "accepted" : "not accepted") +
          "</h1><p>";
  for (const std::string& log : run.logs) {
    html += Escape(std::filesystem::path(log).filename().string()) + " ";
  }
  const Excitation& e = result.excitation;
  html += "&middot; " + Number(e.moving_s, 0) + " s of driving, speed varied by " +
          Fixed(e.speed_rms_mps, 1) + " m/s, yaw rate " + Fixed(e.yaw_rate_rms_radps, 3) +
          " rad/s rms, heading resultant " + Fixed(e.heading_resultant, 2) + ", " +
          std::to_string(e.static_returns) + " returns of standing things, " +
          std::to_string(e.target_windows) + " looks at moving vehicles by radar and camera.</p>";
  for (const std::string& problem : result.problems) {
    html += "<p><strong>" + Escape(problem) + "</strong></p>";
  }
  return html;
}

std::string SensorPictures(const ResidualPictures& pictures) {
  std::string html;
  for (const auto& radar : pictures.radars) {
    html += "<h2>" + Escape(radar.name) + "</h2><div class=\"pair\"><figure>" +
            DrawBins(radar.doppler_by_azimuth, "azimuth [deg]", "range rate, static [m/s]") +
            "<figcaption>Doppler of standing things: a curve here is a bumper that bends azimuth."
            "</figcaption></figure><figure>" +
            DrawBins(radar.range_by_range, "range [m]", "range residual [m]") +
            "<figcaption>Range of moving vehicles: a slope here is a range scale."
            "</figcaption></figure></div>";
  }
  for (const auto& camera : pictures.cameras) {
    html +=
        "<h2>" + Escape(camera.name) + "</h2><figure>" + DrawPixels(camera) +
        "<figcaption>Feet of boxes, residuals ten times enlarged: a pattern over the picture is "
        "a lens that is not the one described.</figcaption></figure>";
  }
  return html;
}

std::string Page(const CalibrationRun& run) {
  const ExtrinsicsResult& result = run.extrinsics;
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<title>Calibration</title><style>";
  html += evaluation::ReportStyle();
  html +=
      ".pair{display:flex;flex-wrap:wrap;gap:12px}.pair svg{max-width:520px}"
      "td:last-child{min-width:170px}td,th{text-align:left;padding:2px "
      "8px}</style></head><body><main>";
  html += HeadText(run);
  html += "<h2>Parameters</h2>" + ParameterTable(result);
  if (!result.weak.empty()) {
    html +=
        "<h2>Directions held at the prior</h2><p>Along these the drive says less than the tape "
        "measure (information in units of the prior's).</p><ul>";
    for (const WeakDirection& weak : result.weak) {
      html += "<li>" + Number(weak.information, 4) + ": " + Escape(weak.description) + "</li>";
    }
    html += "</ul>";
  }
  html +=
      "<h2>Measurements</h2><p>Mean square of the whitened residuals (unknowns that are solved "
      "along soak up a part, so below 1 is usual), and by how much their noise exceeds white "
      "noise.</p>" +
      GroupTable(result);
  html += SensorPictures(result.pictures);
  if (!run.remotes.empty()) {
    html +=
        "<h2>Other vehicles</h2>" + RemoteTable(run.remotes) + "<div class=\"pair\"><figure>" +
        DrawRemotes(run.remotes, 0) + "</figure><figure>" + DrawRemotes(run.remotes, 1) +
        "</figure></div><p>One dot a second and sender; the line is its constant part. Relative "
        "to the ego's own GNSS error: nothing on board can split the two.</p>";
  }
  return html + "</main></body></html>\n";
}

}  // namespace

bool WriteCalibrationReport(const CalibrationRun& run, const std::string& folder,
                            std::string& error) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  const auto path = std::filesystem::path(folder) / "index.html";
  return ReplaceFile(path.string(), Page(run), error);
}

}  // namespace v2vouch
