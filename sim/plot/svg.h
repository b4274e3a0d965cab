// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace v2vouch::evaluation {

/// Shortest decimal form with at most `digits` places, no exponent, no locale: the same bytes
/// everywhere.
std::string Number(double value, int digits = 2);
/// The same with exactly `digits` places, for columns of a table; "none" of what is not finite.
std::string Fixed(double value, int digits);
/// Text made safe for XML and HTML.
std::string Escape(std::string_view text);

/// Colours of the report.
namespace colour {
inline constexpr const char* kLocal = "#2b6cb0";
inline constexpr const char* kV2v = "#d9822b";
inline constexpr const char* kPriority = "#17855a";
inline constexpr const char* kInk = "#2d333b";
inline constexpr const char* kMuted = "#7b8490";
inline constexpr const char* kGrid = "#e6e8ec";
inline constexpr const char* kHidden = "#f7dcd6";
inline constexpr const char* kOutOfView = "#dfdcf0";
inline constexpr const char* kAlarm = "#c0392b";
}  // namespace colour

/// One SVG picture, built element by element. Attributes are passed as written, e.g.
/// `stroke="#000" fill="none"`.
class Svg {
 public:
  Svg(double width, double height);
  void Line(double x1, double y1, double x2, double y2, std::string_view attributes);
  void Rect(double x, double y, double width, double height, std::string_view attributes);
  void Circle(double x, double y, double radius, std::string_view attributes);
  void Polyline(const std::vector<Eigen::Vector2d>& points, std::string_view attributes);
  void Polygon(const std::vector<Eigen::Vector2d>& points, std::string_view attributes);
  void Text(double x, double y, std::string_view text, std::string_view attributes);
  /// Opens and closes a group, e.g. a clip.
  void Open(std::string_view attributes);
  void Close();
  /// Clips everything until Close() to a rectangle; `id` must be unique in the page.
  void OpenClip(std::string_view id, double x, double y, double width, double height);
  [[nodiscard]] std::string Finish() const;

 private:
  std::string body_;
};

/// One curve; a NaN breaks the line.
struct PlotSeries {
  std::string label;
  std::string colour;
  std::vector<Eigen::Vector2d> points;
  bool is_dashed = false;
  double width = 1.8;
};

/// Bands of one label stand together.
struct PlotBand {
  double from = 0.0;
  double to = 0.0;
  std::string fill = colour::kHidden;
  std::string label{};  ///< For the legend; "" = none.
};

/// Lines over time with axes, grid, shaded bands and a legend.
struct Plot {
  std::string id;  ///< Unique in the page.
  std::string x_label = "time [s]";
  std::string y_label;
  double x_from = 0.0;
  double x_to = 1.0;
  double y_least_top = 0.0;  ///< The y axis reaches at least this far.
  std::vector<PlotSeries> series;
  std::vector<PlotBand> bands;
  double width = 1060.0;
  double height = 270.0;
};

std::string Draw(const Plot& plot);

/// Round steps for an axis from 0 or `from` to `to`: 1, 2 or 5 times a power of ten.
double NiceStep(double span, int at_most);

}  // namespace v2vouch::evaluation
