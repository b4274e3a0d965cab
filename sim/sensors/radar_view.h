// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "daemon/common/data/vehicle.h"
#include "sim/sensors/skyline.h"

namespace v2vouch::sim {

/// Range that strengths of reflections are given for.
inline constexpr double kReference_m = 20.0;

/// A fixed strong point of the scenery.
struct Scatterer {
  Vec2 place;
  Vec2 normal;  ///< Zero: seen from everywhere.
  double rcs_dbsm;
  double probability;
};

/// What a radar has before it at the time of a scan.
struct RadarView {
  const RadarConfig& radar;
  Vec2 place;  ///< Of the antenna.
  Vec2 velocity;
  double yaw_rad;
  const Skyline& skyline;
  const std::vector<std::vector<int>>& open_rays;  ///< Per actor: rays that meet it first.
  const std::vector<Scatterer>& scatterers;
  const std::vector<std::pair<Vec2, Vec2>>& mirrors;

  [[nodiscard]] double AzimuthTo(const Vec2& point) const;
  /// Whether the point is within field of view and range.
  [[nodiscard]] bool Covers(const Vec2& point) const;
};

}  // namespace v2vouch::sim
