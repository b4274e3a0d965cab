// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <vector>

#include "sim/plot/svg.h"

namespace v2vouch::evaluation {

inline constexpr double kWidth = 346.0;  ///< Of a bird's eye picture [px].
inline constexpr double kTitle = 24.0;   ///< Height of the line above it.

/// A rectangle of the picture.
struct Area {
  double left, top, right, bottom;
  [[nodiscard]] double Overlap(const Area& other) const {
    return std::max(0.0, std::min(right, other.right) - std::max(left, other.left)) *
           std::max(0.0, std::min(bottom, other.bottom) - std::max(top, other.top));
  }
};

/// Puts names beside their vehicles, where they cover the least of other names and vehicles.
class Labels {
 public:
  explicit Labels(double height) : picture_{0.0, kTitle, kWidth, kTitle + height} {}
  /// A vehicle; its tracks are drawn somewhat larger.
  void Avoid(const Area& area) {
    constexpr double kMargin = 4.0;
    taken_.push_back(
        {area.left - kMargin, area.top - kMargin, area.right + kMargin, area.bottom + kMargin});
  }

  void Draw(Svg& svg, const Area& vehicle, const std::string& name, const char* style,
            double letter_px);

 private:
  Area picture_;
  std::vector<Area> taken_;
};

Area AreaOf(const std::vector<Eigen::Vector2d>& points);

}  // namespace v2vouch::evaluation
