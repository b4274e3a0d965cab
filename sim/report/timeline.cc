// SPDX-License-Identifier: Apache-2.0
#include "sim/report/timeline.h"

#include <algorithm>
#include <map>

#include "sim/plot/svg.h"
#include "sim/report/moments.h"

namespace v2vouch::evaluation {
namespace {

constexpr double kWidth = 1060.0;
constexpr double kLeft = 132.0;
constexpr double kRight = 14.0;
constexpr double kTop = 30.0;
constexpr double kRow = 27.0;
constexpr double kBar = 5.0;

const char* ClassName(int object_class) {
  constexpr std::array kNames = {"vehicle", "car", "van", "truck", "bus", "motorcycle"};
  return object_class >= 0 && object_class < static_cast<int>(kNames.size())
             ? kNames[static_cast<std::size_t>(object_class)]
             : "vehicle";
}

struct Row {
  std::size_t object = 0;
  double nearest_m = 0.0;
  std::vector<char> is_inside;  // Per instant.
};

std::vector<Row> ChooseRows(const Evaluation& evaluation, std::size_t most) {
  std::vector<Row> rows;
  const Truth& truth = evaluation.log.truth;
  for (std::size_t o = 0; o < truth.objects.size(); ++o) {
    if (!truth.objects[o].is_vehicle()) continue;
    Row row{o, 1e9, std::vector<char>(evaluation.grid.size(), 0)};
    for (std::size_t k = 0; k < evaluation.grid.size(); ++k) {
      const auto motion = truth.objects[o].motion.At(evaluation.grid[k]);
      const auto ego = truth.ego.At(evaluation.grid[k]);
      if (!motion || !ego) continue;
      const double distance = (motion->position() - ego->position()).norm();
      row.nearest_m = std::min(row.nearest_m, distance);
      row.is_inside[k] = distance <= evaluation.settings.radius_m ? 1 : 0;
    }
    if (row.nearest_m <= evaluation.settings.radius_m) rows.push_back(std::move(row));
  }
  const auto is_before = [&](const Row& a, const Row& b) {
    const bool va = truth.objects[a.object].has_v2v;
    const bool vb = truth.objects[b.object].has_v2v;
    if (va != vb) return va;
    return std::pair(a.nearest_m, a.object) < std::pair(b.nearest_m, b.object);
  };
  std::sort(rows.begin(), rows.end(), is_before);
  if (rows.size() > most) rows.resize(most);
  std::sort(rows.begin(), rows.end(), [&](const Row& a, const Row& b) {
    const bool va = truth.objects[a.object].has_v2v;
    const bool vb = truth.objects[b.object].has_v2v;
    return va != vb ? va : a.object < b.object;
  });
  return rows;
}

// The picture and its time axis.
struct Chart {
  double period;
  double end_s;
  double bottom;
  Svg svg;

  [[nodiscard]] double X(double t_s) const {
    return kLeft + t_s / end_s * (kWidth - kLeft - kRight);
  }

  void Bar(double from_s, double to_s, double y, double height, const char* fill) {
    svg.Rect(X(from_s), y, std::max(0.6, X(to_s) - X(from_s)), height,
             std::string("fill=\"") + fill + "\"");
  }

  // Runs of instants that follow each other, of one colour.
  void Stretches(const std::vector<char>& on, double y, double height, const char* fill) {
    for (std::size_t k = 0; k < on.size();) {
      std::size_t end = k;
      while (end < on.size() && on[end] != 0) ++end;
      if (end > k) {
        Bar(period * static_cast<double>(k), std::min(end_s, period * static_cast<double>(end)), y,
            height, fill);
      }
      k = std::max(end, k + 1);
    }
  }
};

void DrawLegend(Svg& svg) {
  double legend_x = kLeft;
  const auto legend = [&](const char* label, const char* fill, double width) {
    svg.Rect(legend_x, 9.0, 20.0, 8.0, std::string("fill=\"") + fill + "\"");
    svg.Text(legend_x + 26.0, 17.0, label, "class=\"legend\"");
    legend_x += width;
  };
  legend("LOCAL", colour::kLocal, 90.0);
  legend("V2V", colour::kV2v, 76.0);
  legend("PRIORITY", colour::kPriority, 112.0);
  legend("hidden", colour::kHidden, 86.0);
  legend("out of view", colour::kOutOfView, 114.0);
  legend("within the disc", "#eef0f3", 130.0);
}

// Per list and object: the instants the object is matched at.
using Held = std::array<std::map<std::size_t, std::vector<char>>, 3>;

Held HeldInstants(const Evaluation& evaluation) {
  Held held;
  for (const ListKind kind : kLists) {
    for (const MatchedPair& pair : evaluation.cutoffs.front().all[Index(kind)].pairs) {
      auto& on = held[Index(kind)][pair.object];
      on.resize(evaluation.grid.size(), 0);
      on[pair.instant] = 1;
    }
  }
  return held;
}

void DrawRow(const Evaluation& evaluation, const Row& row, const Held& held, double y,
             Chart& chart) {
  const TruthObject& object = evaluation.log.truth.objects[row.object];
  chart.Stretches(row.is_inside, y + 3.0, kRow - 6.0, "#eef0f3");
  for (const auto& [sighting, fill] : {std::pair(Sighting::kHidden, colour::kHidden),
                                       std::pair(Sighting::kOutOfView, colour::kOutOfView)}) {
    for (const Interval& unseen : UnseenIntervals(evaluation, row.object, false, sighting)) {
      chart.Bar(unseen.from_s, std::min(chart.end_s, unseen.to_s), y + 3.0, kRow - 6.0, fill);
    }
  }
  constexpr std::array kFills = {colour::kLocal, colour::kV2v, colour::kPriority};
  for (const ListKind kind : kLists) {
    const auto found = held[Index(kind)].find(row.object);
    if (found == held[Index(kind)].end()) continue;
    chart.Stretches(found->second, y + 5.0 + (kBar + 1.0) * static_cast<double>(Index(kind)), kBar,
                    kFills[Index(kind)]);
  }
  chart.svg.Text(kLeft - 10.0, y + kRow / 2.0 + 4.0,
                 std::to_string(object.id) + " " + ClassName(object.object_class) +
                     (object.has_v2v ? ", V2V" : ""),
                 "class=\"tick\" text-anchor=\"end\"");
}

void DrawTimeAxis(Chart& chart) {
  Svg& svg = chart.svg;
  const double bottom = chart.bottom;
  const double step = NiceStep(chart.end_s, 14);
  for (double t = 0.0; t <= chart.end_s + 1e-9; t += step) {
    svg.Line(chart.X(t), bottom, chart.X(t), bottom + 4.0,
             std::string("stroke=\"") + colour::kMuted + "\"");
    svg.Text(chart.X(t), bottom + 17.0, Number(t), "class=\"tick\" text-anchor=\"middle\"");
  }
  svg.Line(kLeft, bottom, kWidth - kRight, bottom,
           std::string("stroke=\"") + colour::kMuted + "\"");
  svg.Text((kLeft + kWidth - kRight) / 2.0, bottom + 33.0, "time [s]",
           "class=\"label\" text-anchor=\"middle\"");
}

}  // namespace

std::string Timeline(const Evaluation& evaluation, std::size_t rows_at_most) {
  const std::vector<Row> rows = ChooseRows(evaluation, rows_at_most);
  const double period = evaluation.settings.period_s;
  const double end_s = std::max(period, evaluation.duration_s);
  const double bottom = kTop + kRow * static_cast<double>(rows.size());
  Chart chart{period, end_s, bottom, Svg(kWidth, bottom + 36.0)};
  DrawLegend(chart.svg);
  const Held held = HeldInstants(evaluation);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    DrawRow(evaluation, rows[r], held, kTop + kRow * static_cast<double>(r), chart);
  }
  DrawTimeAxis(chart);
  return chart.svg.Finish();
}

}  // namespace v2vouch::evaluation
