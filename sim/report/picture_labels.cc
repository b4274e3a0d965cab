// SPDX-License-Identifier: Apache-2.0
#include "sim/report/picture_labels.h"

#include <array>

namespace v2vouch::evaluation {

void Labels::Draw(Svg& svg, const Area& vehicle, const std::string& name, const char* style,
                  double letter_px) {
  const double width = letter_px * static_cast<double>(name.size());
  const double height = 1.7 * letter_px;
  const double x = 0.5 * (vehicle.left + vehicle.right);
  const double y = 0.5 * (vehicle.top + vehicle.bottom);
  constexpr double kGap = 6.0;
  const auto at = [&](double left, double top) {
    return Area{left, top, left + width, top + height};
  };
  const std::array candidates = {at(vehicle.right + kGap, y - height / 2),
                                 at(vehicle.left - kGap - width, y - height / 2),
                                 at(x - width / 2, vehicle.top - height - 4.0),
                                 at(x - width / 2, vehicle.bottom + 4.0),
                                 at(vehicle.right + kGap, vehicle.top - height),
                                 at(vehicle.left - kGap - width, vehicle.top - height),
                                 at(vehicle.right + kGap, vehicle.bottom),
                                 at(vehicle.left - kGap - width, vehicle.bottom)};
  const Area* best = &candidates[0];
  double least = 1e9;
  for (const Area& candidate : candidates) {
    const double outside = width * height - candidate.Overlap(picture_);
    double covered = outside;
    for (const Area& taken : taken_) covered += candidate.Overlap(taken);
    if (covered < least - 0.5) {
      least = covered;
      best = &candidate;
    }
  }
  svg.Text(best->left, best->bottom - 0.25 * height, name, std::string("class=\"") + style + '"');
  taken_.push_back(*best);
}

Area AreaOf(const std::vector<Eigen::Vector2d>& points) {
  Area area{points[0].x(), points[0].y(), points[0].x(), points[0].y()};
  for (const Eigen::Vector2d& p : points) {
    area = {std::min(area.left, p.x()), std::min(area.top, p.y()), std::max(area.right, p.x()),
            std::max(area.bottom, p.y())};
  }
  return area;
}

}  // namespace v2vouch::evaluation
