// SPDX-License-Identifier: Apache-2.0
#include "sim/plot/svg.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace v2vouch::evaluation {
namespace {

std::string PointList(const std::vector<Eigen::Vector2d>& points) {
  std::string out;
  for (const auto& p : points) {
    if (!out.empty()) out += ' ';
    out += Number(p.x()) + "," + Number(p.y());
  }
  return out;
}

}  // namespace

std::string Fixed(double value, int digits) {
  if (!std::isfinite(value)) return "none";
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, digits);
  return {text, end.ptr};
}

std::string Number(double value, int digits) {
  std::string out = Fixed(value, digits);
  if (out.find('.') != std::string::npos) {
    out.erase(out.find_last_not_of('0') + 1);
    if (out.back() == '.') out.pop_back();
  }
  return out == "-0" ? "0" : out;
}

std::string Escape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

Svg::Svg(double width, double height) {
  body_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + Number(width) + " " +
          Number(height) + "\" width=\"" + Number(width) + "\" height=\"" + Number(height) +
          "\" role=\"img\">\n";
}

void Svg::Line(double x1, double y1, double x2, double y2, std::string_view attributes) {
  body_ += "<line x1=\"" + Number(x1) + "\" y1=\"" + Number(y1) + "\" x2=\"" + Number(x2) +
           "\" y2=\"" + Number(y2) + "\" " + std::string(attributes) + "/>\n";
}

void Svg::Rect(double x, double y, double width, double height, std::string_view attributes) {
  body_ += "<rect x=\"" + Number(x) + "\" y=\"" + Number(y) + "\" width=\"" +
           Number(std::max(0.0, width)) + "\" height=\"" + Number(std::max(0.0, height)) + "\" " +
           std::string(attributes) + "/>\n";
}

void Svg::Circle(double x, double y, double radius, std::string_view attributes) {
  body_ += "<circle cx=\"" + Number(x) + "\" cy=\"" + Number(y) + "\" r=\"" + Number(radius) +
           "\" " + std::string(attributes) + "/>\n";
}

void Svg::Polyline(const std::vector<Eigen::Vector2d>& points, std::string_view attributes) {
  body_ += "<polyline points=\"" + PointList(points) + "\" " + std::string(attributes) + "/>\n";
}

void Svg::Polygon(const std::vector<Eigen::Vector2d>& points, std::string_view attributes) {
  body_ += "<polygon points=\"" + PointList(points) + "\" " + std::string(attributes) + "/>\n";
}

void Svg::Text(double x, double y, std::string_view text, std::string_view attributes) {
  body_ += "<text x=\"" + Number(x) + "\" y=\"" + Number(y) + "\" " + std::string(attributes) +
           ">" + Escape(text) + "</text>\n";
}

void Svg::Open(std::string_view attributes) { body_ += "<g " + std::string(attributes) + ">\n"; }

void Svg::Close() { body_ += "</g>\n"; }

void Svg::OpenClip(std::string_view id, double x, double y, double width, double height) {
  body_ += "<clipPath id=\"" + std::string(id) + "\">";
  Rect(x, y, width, height, "");
  body_ += "</clipPath>\n";
  Open("clip-path=\"url(#" + std::string(id) + ")\"");
}

std::string Svg::Finish() const { return body_ + "</svg>\n"; }

double NiceStep(double span, int at_most) {
  if (!(span > 0.0)) return 1.0;
  double step = std::pow(10.0, std::floor(std::log10(span / at_most)));
  for (const double factor : {2.0, 2.5, 2.0}) {  // 1, 2, 5, 10
    if (span / step <= at_most) break;
    step *= factor;
  }
  return step;
}

namespace {

constexpr double kLeft = 58.0, kRight = 14.0, kTop = 34.0, kBottom = 42.0;

// Where values lie in the picture.
class Axes {
 public:
  explicit Axes(const Plot& plot)
      : x_from(plot.x_from),
        x_span(std::max(plot.x_to - plot.x_from, 1e-6)),
        inner_width(plot.width - kLeft - kRight),
        inner_height(plot.height - kTop - kBottom),
        top(plot.y_least_top) {
    for (const auto& series : plot.series) {
      for (const auto& p : series.points) {
        if (std::isfinite(p.y())) top = std::max(top, p.y());
      }
    }
    if (!(top > 0.0)) top = 1.0;
    y_step = NiceStep(top * 1.05, 5);
    top *= 1.03;  // A little air above the highest value.
  }

  [[nodiscard]] double X(double x) const { return kLeft + (x - x_from) / x_span * inner_width; }
  [[nodiscard]] double Y(double y) const { return kTop + (1.0 - y / top) * inner_height; }

  double x_from;
  double x_span;
  double inner_width;
  double inner_height;
  double top;
  double y_step = 1.0;
};

void DrawBands(const Plot& plot, const Axes& axes, Svg& svg) {
  for (const PlotBand& band : plot.bands) {
    const double from = std::max(band.from, plot.x_from);
    const double to = std::min(band.to, plot.x_to);
    svg.Rect(axes.X(from), kTop, axes.X(to) - axes.X(from), axes.inner_height,
             std::string("fill=\"") + band.fill + "\"");
  }
}

void DrawGrid(const Plot& plot, const Axes& axes, Svg& svg) {
  const std::string grid = std::string("stroke=\"") + colour::kGrid + "\"";
  for (double y = 0.0; y <= axes.top * 1.0001; y += axes.y_step) {
    svg.Line(kLeft, axes.Y(y), plot.width - kRight, axes.Y(y), grid);
    svg.Text(kLeft - 8.0, axes.Y(y) + 4.0, Number(y), "class=\"tick\" text-anchor=\"end\"");
  }
  const double x_step = NiceStep(axes.x_span, 14);
  for (double x = std::ceil(plot.x_from / x_step - 1e-9) * x_step; x <= plot.x_to + 1e-9;
       x += x_step) {
    svg.Line(axes.X(x), kTop + axes.inner_height, axes.X(x), kTop + axes.inner_height + 4.0,
             std::string("stroke=\"") + colour::kMuted + "\"");
    svg.Text(axes.X(x), kTop + axes.inner_height + 18.0, Number(x),
             "class=\"tick\" text-anchor=\"middle\"");
  }
  svg.Line(kLeft, axes.Y(0.0), plot.width - kRight, axes.Y(0.0),
           std::string("stroke=\"") + colour::kMuted + "\"");
  svg.Text(kLeft + axes.inner_width / 2.0, plot.height - 6.0, plot.x_label,
           "class=\"label\" text-anchor=\"middle\"");
  svg.Text(0.0, 0.0, plot.y_label,
           "class=\"label\" text-anchor=\"middle\" transform=\"translate(14 " +
               Number(kTop + axes.inner_height / 2.0) + ") rotate(-90)\"");
}

void DrawSeries(const PlotSeries& series, const Axes& axes, Svg& svg) {
  const std::string style = "fill=\"none\" stroke=\"" + series.colour + "\" stroke-width=\"" +
                            Number(series.width) + "\" stroke-linejoin=\"round\"" +
                            (series.is_dashed ? " stroke-dasharray=\"5 4\"" : "");
  std::vector<Eigen::Vector2d> run;
  const auto flush = [&] {
    if (run.size() == 1) {
      svg.Circle(run[0].x(), run[0].y(), std::max(2.5, series.width),
                 "fill=\"" + series.colour + "\"");
    } else if (!run.empty()) {
      svg.Polyline(run, style);
    }
    run.clear();
  };
  for (const auto& p : series.points) {
    if (std::isfinite(p.y())) {
      run.emplace_back(axes.X(p.x()), axes.Y(p.y()));
    } else {
      flush();
    }
  }
  flush();
}

void DrawLegend(const Plot& plot, Svg& svg) {
  double x = kLeft;
  const auto legend_text = [&](const std::string& label) {
    svg.Text(x, 19.0, label, "class=\"legend\"");
    x += 7.6 * static_cast<double>(label.size()) + 26.0;
  };
  for (const auto& series : plot.series) {
    svg.Line(x, 15.0, x + 22.0, 15.0,
             "stroke=\"" + series.colour + "\" stroke-width=\"2.4\"" +
                 (series.is_dashed ? " stroke-dasharray=\"5 4\"" : ""));
    x += 28.0;
    legend_text(series.label);
  }
  std::string_view last_label;
  for (const PlotBand& band : plot.bands) {
    if (band.label.empty() || band.label == last_label) continue;
    last_label = band.label;
    svg.Rect(x, 8.0, 22.0, 13.0, std::string("fill=\"") + band.fill + "\"");
    x += 28.0;
    legend_text(band.label);
  }
}

}  // namespace

std::string Draw(const Plot& plot) {
  const Axes axes(plot);
  Svg svg(plot.width, plot.height);
  DrawBands(plot, axes, svg);
  DrawGrid(plot, axes, svg);
  svg.OpenClip("clip-" + plot.id, kLeft, kTop - 2.0, axes.inner_width, axes.inner_height + 4.0);
  for (const PlotSeries& series : plot.series) DrawSeries(series, axes, svg);
  svg.Close();
  DrawLegend(plot, svg);
  return svg.Finish();
}

}  // namespace v2vouch::evaluation
