// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/association/height_track.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

constexpr double kFade_m = 60.0;  // Way after which a height counts 1/e.
constexpr double kFade = 0.98;    // Per height.
constexpr double kFresh_s = 5.0;
// Below this spread of places (1 sigma) noise of the heights is read as a grade.
constexpr double kLeastSpread_m = 5.0;
// Errors of a receiver's heights vary by so much over a few seconds of driving; less scatter than
// this proves nothing.
constexpr double kSlowError_m = 0.3;
constexpr double kSteepest = 0.25;  // No road is steeper (Baldwin Street: 0.35 over 160 m).

}  // namespace

void HeightTrack::Add(Timestamp stamp, double moved_m, std::optional<double> height_m) {
  const double fade = std::exp(-std::abs(moved_m) / kFade_m) * (height_m ? kFade : 1.0);
  weight_ *= fade;
  way_way_ *= fade;
  way_height_ *= fade;
  height_height_ *= fade;
  mean_way_m_ -= moved_m;
  if (!height_m) return;
  last_ = stamp;
  weight_ += 1.0;
  const double way = 0.0 - mean_way_m_;
  const double height = *height_m - mean_height_m_;
  mean_way_m_ += way / weight_;
  mean_height_m_ += height / weight_;
  const double share = (weight_ - 1.0) / weight_;
  way_way_ += share * way * way;
  way_height_ += share * way * height;
  height_height_ += share * height * height;
}

std::optional<double> HeightTrack::HeightAt(Timestamp now) const {
  if (!last_ || std::abs(ToSeconds(now - *last_)) > kFresh_s) return std::nullopt;
  const bool has_line = way_way_ > kLeastSpread_m * kLeastSpread_m * weight_;
  const double slope = has_line ? std::clamp(way_height_ / way_way_, -kSteepest, kSteepest) : 0.0;
  return mean_height_m_ - slope * mean_way_m_;
}

double HeightTrack::grade() const {
  if (weight_ < 3.0 || way_way_ <= kLeastSpread_m * kLeastSpread_m * weight_) return 0.0;
  const double slope = way_height_ / way_way_;
  const double scatter =
      std::max(0.0, height_height_ - slope * way_height_) / std::max(1.0, weight_ - 2.0);
  const double sigma =
      std::sqrt(scatter / way_way_ + kSlowError_m * kSlowError_m * weight_ / way_way_);
  return std::copysign(std::min(kSteepest, std::max(0.0, std::abs(slope) - sigma)), slope);
}

}  // namespace v2vouch
