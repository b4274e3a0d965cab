// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/road_map.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>

#include "daemon/common/base/angle.h"

namespace v2vouch::view {
namespace {

constexpr std::size_t kMostPoints = 4096;
constexpr double kFarthest_m = 1e5;

// yaml-cpp's non-const operator[] would create what it does not find.
YAML::Node Child(const YAML::Node& node, const char* key) {
  if (!node || !node.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
  return node[key];
}

double NumberOr(const YAML::Node& node, const char* key, double fallback) {
  const YAML::Node value = Child(node, key);
  return value && value.IsScalar() ? value.as<double>(fallback) : fallback;
}

std::optional<MapPoint> PointOf(const YAML::Node& node) {
  const MapPoint point{NumberOr(node, "x_m", NAN), NumberOr(node, "y_m", NAN)};
  if (!(std::abs(point.x_m) <= kFarthest_m && std::abs(point.y_m) <= kFarthest_m)) {
    return std::nullopt;
  }
  return point;
}

// The corner's curve, as the simulator drives it: a circle that touches both legs.
void AddCorner(const MapPoint& before, const MapPoint& corner, const MapPoint& after,
               double radius_m, std::vector<MapPoint>& line) {
  const double in_x = corner.x_m - before.x_m, in_y = corner.y_m - before.y_m;
  const double out_x = after.x_m - corner.x_m, out_y = after.y_m - corner.y_m;
  const double in = std::hypot(in_x, in_y), out = std::hypot(out_x, out_y);
  if (in < 1e-6 || out < 1e-6) return;
  const double turn = AngleDifference(std::atan2(out_y, out_x), std::atan2(in_y, in_x));
  const double leg = std::min({radius_m * std::tan(std::abs(turn) / 2), in / 2, out / 2});
  constexpr int kSteps = 8;
  for (int i = 0; i <= kSteps; ++i) {  // A quadratic curve is near enough to the circle.
    const double s = static_cast<double>(i) / kSteps;
    const double a = (1 - s) * (1 - s) * leg / in, b = s * s * leg / out;
    line.push_back({corner.x_m - a * in_x + b * out_x, corner.y_m - a * in_y + b * out_y});
  }
}

std::vector<MapPoint> Outline(const YAML::Node& building) {
  std::vector<MapPoint> outline;
  const YAML::Node corners = Child(building, "outline");
  if (corners && corners.IsSequence() && corners.size() >= 3) {
    for (const YAML::Node& corner : corners) {
      if (const auto point = PointOf(corner)) outline.push_back(*point);
    }
    return outline;
  }
  const auto centre = PointOf(building);
  if (!centre) return outline;
  const double length = 0.5 * NumberOr(building, "length_m", 10.0);
  const double width = 0.5 * NumberOr(building, "width_m", 10.0);
  const double yaw = FromDegrees(NumberOr(building, "yaw_deg", 0.0));
  if (!(length <= kFarthest_m && width <= kFarthest_m)) return outline;
  for (const auto& [a, b] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}) {
    const double x = a * length, y = b * width;
    outline.push_back({centre->x_m + x * std::cos(yaw) - y * std::sin(yaw),
                       centre->y_m + x * std::sin(yaw) + y * std::cos(yaw)});
  }
  return outline;
}

std::vector<MapPoint> Lane(const YAML::Node& route) {
  std::vector<MapPoint> points;
  std::vector<double> radii;
  const YAML::Node waypoints = Child(route, "waypoints");
  if (!waypoints || !waypoints.IsSequence()) return {};
  for (const YAML::Node& waypoint : waypoints) {
    if (points.size() >= kMostPoints / 8) break;
    const auto point = PointOf(waypoint);
    if (!point) continue;
    points.push_back(*point);
    radii.push_back(NumberOr(waypoint, "radius_m", 10.0));
  }
  if (points.size() < 2) return {};
  std::vector<MapPoint> line = {points.front()};
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    AddCorner(points[i - 1], points[i], points[i + 1], radii[i], line);
  }
  line.push_back(points.back());
  return line;
}

template <class MakeLine>
void Fill(const YAML::Node& list, MakeLine make, std::vector<std::vector<MapPoint>>& lines) {
  if (!list || !list.IsSequence()) return;
  std::size_t points = 0;
  for (const YAML::Node& node : list) {
    auto line = make(node);
    points += line.size();
    if (points > kMostPoints) return;
    if (line.size() >= 2) lines.push_back(std::move(line));
  }
}

}  // namespace

RoadMap ReadRoadMap(const std::string& scenario_yaml) {
  RoadMap map;
  try {
    const YAML::Node root = YAML::Load(scenario_yaml);
    const YAML::Node name = Child(root, "name");
    if (name && name.IsScalar()) map.name = name.Scalar().substr(0, 64);
    Fill(Child(root, "routes"), Lane, map.lanes);
    Fill(Child(root, "buildings"), Outline, map.buildings);
  } catch (const std::exception&) {  // No YAML: no map.
    return {};
  }
  return map;
}

}  // namespace v2vouch::view
