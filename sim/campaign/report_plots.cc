// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/report_plots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "sim/campaign/families.h"
#include "sim/plot/svg.h"

namespace v2vouch::campaign {
namespace {

using evaluation::AttackFigures;
using evaluation::Escape;
using evaluation::Fixed;
using evaluation::Plot;
using evaluation::PlotSeries;
using evaluation::PooledF1;
using evaluation::Svg;
namespace colour = evaluation::colour;

constexpr double kHorizon_s = 25.0;  // Attacks begin at 15 s of 40.
constexpr std::size_t kMostLines = 6;

std::string Fill(const char* of) { return std::string("fill=\"") + of + "\""; }

const char* LineColour(std::size_t i) {
  constexpr std::array kColours = {"#17855a", "#d9822b", "#2b6cb0",
                                   "#c0392b", "#7b5ea7", "#7b8490"};
  return kColours[i % kColours.size()];
}

// Too many lines say nothing: those that reach highest stay.
template <class Height>
std::vector<const Group*> Highest(std::vector<const Group*> groups, Height height) {
  if (groups.size() <= kMostLines) return groups;
  std::vector<const Group*> highest = groups;
  std::stable_sort(highest.begin(), highest.end(),
                   [&](const Group* a, const Group* b) { return height(*a) > height(*b); });
  highest.resize(kMostLines);
  std::erase_if(groups, [&](const Group* group) {
    return std::find(highest.begin(), highest.end(), group) == highest.end();
  });
  return groups;
}

struct Bar {
  const char* colour;
  double f1;
  std::optional<double> low, high;
};

std::vector<Bar> BarsOf(const Group& group) {
  std::vector<Bar> bars;
  const auto add = [&](const char* of, const PooledF1& f1) {
    if (f1.f1) bars.push_back({of, *f1.f1, f1.low, f1.high});
  };
  add(colour::kPriority, group.attack.by_message);
  if (group.attack.checks_by_message) add(colour::kV2v, *group.attack.checks_by_message);
  if (const auto published = PublishedF1(group.name())) {
    bars.push_back({colour::kMuted, *published, std::nullopt, std::nullopt});
  }
  return bars;
}

std::string Legend(Svg& svg, double left) {
  const std::array<std::pair<const char*, const char*>, 3> kinds = {
      {{colour::kPriority, "ours"},
       {colour::kV2v, "message-only checks, same messages"},
       {colour::kMuted, "CaTCH on VeReMi NextGen, published"}}};
  double x = left;
  for (const auto& [of, label] : kinds) {
    svg.Rect(x, 8.0, 14.0, 12.0, Fill(of));
    svg.Text(x + 20.0, 19.0, label, "class=\"legend\"");
    x += 48.0 + 7.2 * static_cast<double>(std::string_view(label).size());
  }
  return {};
}

}  // namespace

std::string F1Bars(const std::vector<const Group*>& groups) {
  constexpr double kLeft = 230.0, kWidth = 1060.0, kTop = 34.0, kBar = 9.0, kGap = 9.0;
  std::vector<std::pair<const Group*, std::vector<Bar>>> rows;
  double height = kTop + 30.0;
  for (const Group* group : groups) {
    // A landmark alone would be no comparison.
    if (!group->attack.by_message.f1) continue;
    rows.emplace_back(group, BarsOf(*group));
    height += kBar * static_cast<double>(rows.back().second.size()) + kGap;
  }
  if (rows.empty()) return "";
  const double span = kWidth - kLeft - 70.0;
  Svg svg(kWidth, height);
  Legend(svg, kLeft);
  for (int i = 0; i <= 5; ++i) {
    const double x = kLeft + span * i / 5.0;
    svg.Line(x, kTop - 4.0, x, height - 24.0, std::string("stroke=\"") + colour::kGrid + "\"");
    svg.Text(x, height - 8.0, Fixed(i / 5.0, 1), "class=\"tick\" text-anchor=\"middle\"");
  }
  double y = kTop;
  for (const auto& [group, bars] : rows) {
    const double middle = y + 0.5 * kBar * static_cast<double>(bars.size()) + 4.0;
    svg.Text(kLeft - 10.0, middle, group->name(), "class=\"label\" text-anchor=\"end\"");
    for (const Bar& bar : bars) {
      svg.Rect(kLeft, y, std::max(1.0, span * bar.f1), kBar - 1.5, Fill(bar.colour));
      if (bar.low && bar.high) {
        const double at = y + 0.5 * (kBar - 1.5);
        svg.Line(kLeft + span * *bar.low, at, kLeft + span * *bar.high, at,
                 std::string("stroke=\"") + colour::kInk + "\" stroke-width=\"1.4\"");
      }
      const double end = std::max(bar.f1, bar.high.value_or(0.0));
      svg.Text(kLeft + span * end + 6.0, y + kBar - 1.0, Fixed(bar.f1, 3),
               "class=\"tick\" font-size=\"10\"");
      y += kBar;
    }
    y += kGap;
  }
  return svg.Finish();
}

std::string LieBars(const std::vector<const Group*>& groups) {
  constexpr double kLeft = 110.0, kWidth = 860.0, kTop = 34.0, kBar = 8.0, kRow = 21.0;
  std::vector<const Group*> shown;
  for (const Group* group : groups) {
    if (group->warnings && group->warnings->runs > 0) shown.push_back(group);
  }
  if (shown.empty()) return "";
  const double height = kTop + kRow * static_cast<double>(shown.size()) + 44.0;
  const double span = kWidth - kLeft - 90.0;
  Svg svg(kWidth, height);
  double x = kLeft;
  for (const auto& [of, label] : {std::pair{colour::kV2v, "V2V alone"},
                                  std::pair{colour::kPriority, "ours: PRIORITY and LOCAL"}}) {
    svg.Rect(x, 8.0, 14.0, 12.0, Fill(of));
    svg.Text(x + 20.0, 19.0, label, "class=\"legend\" font-size=\"13\"");
    x += 140.0;
  }
  for (int i = 0; i <= 5; ++i) {
    const double at = kLeft + span * i / 5.0;
    svg.Line(at, kTop - 4.0, at, height - 40.0, std::string("stroke=\"") + colour::kGrid + "\"");
    svg.Text(at, height - 26.0, std::to_string(20 * i) + " %",
             "class=\"tick\" font-size=\"12\" text-anchor=\"middle\"");
  }
  svg.Text(kLeft, height - 7.0,
           "share of the attacked runs in which a lie causes an URGENT warning",
           "class=\"tick\" font-size=\"12\"");
  double y = kTop;
  for (const Group* group : shown) {
    const auto& tally = *group->warnings;
    svg.Text(kLeft - 10.0, y + kBar + 4.0, group->name(),
             "class=\"label\" font-size=\"12\" text-anchor=\"end\"");
    double at_y = y;
    for (const auto& [of, count] : {std::pair{colour::kV2v, tally.v2v.runs_by_lie},
                                    std::pair{colour::kPriority, tally.ours.runs_by_lie}}) {
      const double length = span * count / tally.runs;
      svg.Rect(kLeft, at_y, std::max(1.0, length), kBar - 1.0, Fill(of));
      svg.Text(kLeft + length + 6.0, at_y + kBar - 0.5,
               std::to_string(count) + " of " + std::to_string(tally.runs),
               "class=\"tick\" font-size=\"9\"");
      at_y += kBar;
    }
    y += kRow;
  }
  return svg.Finish();
}

std::string ExposureOverTime(const std::vector<const Group*>& groups, const std::string& id) {
  std::vector<const Group*> exposed;
  for (const Group* group : groups) {
    if (group->attack.exposure_max_m > 0.0) exposed.push_back(group);
  }
  if (exposed.empty()) return "";
  exposed = Highest(exposed, [](const Group& group) { return group.attack.exposure_max_m; });
  Plot plot;
  plot.id = "exposure-" + id;
  plot.x_label = "time since the attack began [s]";
  plot.y_label = "largest exposure [m]";
  plot.x_to = kHorizon_s;
  plot.y_least_top = 5.0;
  for (std::size_t i = 0; i < exposed.size(); ++i) {
    PlotSeries series{exposed[i]->name(), LineColour(i), {}, false, 1.8};
    const auto& curve = exposed[i]->attack.curve_m;
    for (std::size_t bin = 0; bin < curve.size(); ++bin) {
      const double at_s = (static_cast<double>(bin) + 0.5) * evaluation::Exposure::kBin_s;
      series.points.emplace_back(at_s, curve[bin]);
    }
    plot.series.push_back(std::move(series));
  }
  return Draw(plot);
}

std::string MetOverTime(const std::vector<const Group*>& groups, const std::string& id) {
  std::vector<const Group*> measured;
  for (const Group* group : groups) {
    if (group->attack.met_after.count() > 0) measured.push_back(group);
  }
  if (measured.empty()) return "";
  // The slowest tell most.
  measured = Highest(measured, [](const Group& group) {
    const auto median = group.attack.met_after.Percentile(0.5);
    return median ? *median : std::numeric_limits<double>::infinity();
  });
  Plot plot;
  plot.id = "met-" + id;
  plot.x_label = "time since the first false message in view [s]";
  plot.y_label = "attackers met [%]";
  plot.x_to = 15.0;
  plot.y_least_top = 98.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    PlotSeries series{measured[i]->name(), LineColour(i), {}, false, 1.8};
    std::vector<double> times = measured[i]->attack.met_after.times_s;
    std::sort(times.begin(), times.end());
    const auto all = static_cast<double>(measured[i]->attack.met_after.count());
    double met = 0.0;
    series.points.emplace_back(0.0, 0.0);
    for (const double t : times) {
      series.points.emplace_back(t, 100.0 * met / all);
      met += 1.0;
      series.points.emplace_back(t, 100.0 * met / all);
    }
    series.points.emplace_back(plot.x_to, 100.0 * met / all);
    plot.series.push_back(std::move(series));
  }
  return Draw(plot);
}

std::string DriftPlots(const std::vector<const Group*>& groups, const std::string& id) {
  // By direction: rate -> group.
  std::map<std::string, std::map<double, const Group*>> directions;
  for (const Group* group : groups) {
    const std::size_t cut = group->variant.find('_');
    if (cut == std::string::npos) continue;
    double rate = 0.0;
    if (std::sscanf(group->variant.c_str() + cut + 1, "%lfmps", &rate) != 1) continue;
    directions[group->variant.substr(0, cut)][rate] = group;
  }
  if (directions.empty()) return "";
  Plot time, exposure;
  time.id = "drift-time-" + id;
  time.x_label = exposure.x_label = "rate of the drift [m/s]";
  time.y_label = "median time until met [s]";
  time.x_to = exposure.x_to = 2.1;
  exposure.id = "drift-exposure-" + id;
  exposure.y_label = "largest exposure [m]";
  std::size_t i = 0;
  for (const auto& [direction, by_rate] : directions) {
    PlotSeries times{direction, LineColour(i), {}, false, 1.8};
    PlotSeries exposures = times;
    for (const auto& [rate, group] : by_rate) {
      const auto median = group->attack.met_after.Percentile(0.5);
      times.points.emplace_back(rate, median.value_or(std::numeric_limits<double>::quiet_NaN()));
      exposures.points.emplace_back(rate, group->attack.exposure_max_m);
    }
    time.series.push_back(std::move(times));
    exposure.series.push_back(std::move(exposures));
    ++i;
  }
  return Draw(time) + Draw(exposure);
}

}  // namespace v2vouch::campaign
