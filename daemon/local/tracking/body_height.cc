// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/body_height.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/models/extent.h"

namespace v2vouch {
namespace {

// Pitch and the bumps of a road last for about so many pictures.
constexpr double kPicturesAlike = 4.0;
// Of an upper edge: roofs are round, racks and hatches stick out.
constexpr double kRoof_m = 0.15;
constexpr double kLeastSigma_m = 0.05;
// Farther away a lasting error of pitch is as large as what parts a car from a van.
constexpr double kMostEdge_m = 0.25;
// Road vehicles are higher than the first and lower than the second (Directive 96/53/EC: 4 m).
constexpr double kLowest_m = 0.8;
constexpr double kHighest_m = 4.6;
// Passenger cars end below the first, vans lie between the second and the third, lorries and
// buses begin at the last.
constexpr double kCarBelow_m = 1.85;
constexpr double kVanFrom_m = 1.95;
constexpr double kVanBelow_m = 2.45;
constexpr double kLorryFrom_m = 2.8;

}  // namespace

void BodyHeight::Add(const CameraLook& look, const CameraMeasurement& z, double range_m) {
  if (!std::isfinite(z.top_depression_rad)) return;
  const double height_m = look.camera.z_m - range_m * std::tan(z.top_depression_rad);
  if (!(height_m > kLowest_m && height_m < kHighest_m)) return;
  const double edge_m = range_m * z.depression_sigma_rad;
  if (edge_m > kMostEdge_m) return;
  const double variance_m2 = kPicturesAlike * (edge_m * edge_m + kRoof_m * kRoof_m);
  if (variance_m2_ == 0.0) {
    mean_m_ = height_m;
    variance_m2_ = variance_m2;
  } else {
    const double gain = variance_m2_ / (variance_m2_ + variance_m2);
    mean_m_ += gain * (height_m - mean_m_);
    variance_m2_ = std::max((1.0 - gain) * variance_m2_, kLeastSigma_m * kLeastSigma_m);
  }
  const double sigma_m = std::sqrt(variance_m2_);
  if (mean_m_ + sigma_m < kCarBelow_m) {
    kind_ = Kind::kLow;
  } else if (mean_m_ - sigma_m > kVanFrom_m && mean_m_ + sigma_m < kVanBelow_m) {
    kind_ = Kind::kMiddle;
  } else if (mean_m_ - sigma_m > kLorryFrom_m) {
    kind_ = Kind::kHigh;
  }
}

ObjectClass BodyHeight::Plausible(ObjectClass named) const {
  const bool is_long = IsLong(named);
  if (!is_long && named != ObjectClass::kCar && named != ObjectClass::kVan) return named;
  switch (kind_) {
    case Kind::kLow:
      return ObjectClass::kCar;
    case Kind::kMiddle:
      return ObjectClass::kVan;
    case Kind::kHigh:
      return is_long ? named : ObjectClass::kTruck;
    case Kind::kOpen:
      break;
  }
  return named;
}

}  // namespace v2vouch
