// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "daemon/common/data/measurement.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// Where the moving clutter of one scan lies: interference fills a ring or a beam, not all of the
/// field of view. The density relative to an even one, as the product of what range and azimuth
/// show by themselves.
class CrowdShape {
 public:
  void Fill(const RadarConfig& radar, std::span<const RadarMeasurement> measurements) {
    radar_ = &radar;
    in_range_.fill(0.0);
    in_azimuth_.fill(0.0);
    double moving = 0.0;
    for (const RadarMeasurement& z : measurements) {
      if (z.is_static) continue;
      in_range_[RangeBand(z)] += 1.0;
      in_azimuth_[AzimuthBand(z)] += 1.0;
      moving += 1.0;
    }
    for (double& share : in_range_) share *= kBands / moving;
    for (double& share : in_azimuth_) share *= kBands / moving;
  }

  /// At a measurement that Fill was given; above 0.
  [[nodiscard]] double At(const RadarMeasurement& z) const {
    return in_range_[RangeBand(z)] * in_azimuth_[AzimuthBand(z)];
  }

 private:
  static constexpr std::size_t kBands = 16;

  static std::size_t Band(double share) {  // Anything for what is not finite.
    return static_cast<std::size_t>(share > 0.0 ? std::min(share * kBands, kBands - 1.0) : 0.0);
  }
  [[nodiscard]] std::size_t RangeBand(const RadarMeasurement& z) const {
    return Band((z.range_m - radar_->min_range_m) / (radar_->max_range_m - radar_->min_range_m));
  }
  [[nodiscard]] std::size_t AzimuthBand(const RadarMeasurement& z) const {
    return Band(0.5 + 0.5 * z.azimuth_rad / radar_->half_fov_rad);
  }

  const RadarConfig* radar_ = nullptr;
  std::array<double, kBands> in_range_{};
  std::array<double, kBands> in_azimuth_{};
};

}  // namespace v2vouch
