// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/ego_track.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibration/extrinsics/white_noise.h"

namespace v2vouch {
namespace {

constexpr double kNear_s = 0.06;
constexpr double kSlope_s = 0.1;  // Either way.

}  // namespace

EgoTrack::EgoTrack(const std::vector<EgoMotion>& motion) {
  std::vector<double> speeds, rates, speed_sigmas, rate_sigmas;
  for (const EgoMotion& m : motion) {
    if (!samples_.empty() && m.stamp <= samples_.back().stamp) continue;
    samples_.push_back(
        {.stamp = m.stamp, .speed_mps = m.speed_mps, .yaw_rate_radps = m.yaw_rate_radps});
    speed_sigmas.push_back(m.speed_sigma_mps);
    rate_sigmas.push_back(m.yaw_rate_sigma_radps);
    if (std::abs(m.speed_mps) < 0.5) continue;  // At rest the odometer carries no information.
    speeds.push_back(m.speed_mps);
    rates.push_back(m.yaw_rate_radps);
  }
  if (samples_.empty()) return;
  speed_sigma_mps_ = WhiteSigmaWithin(speeds, std::move(speed_sigmas), speed_sigma_mps_);
  yaw_rate_sigma_radps_ = WhiteSigmaWithin(rates, std::move(rate_sigmas), yaw_rate_sigma_radps_);

  std::size_t from = 0;
  std::size_t to = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    Sample& sample = samples_[i];
    while (ToSeconds(sample.stamp - samples_[from].stamp) > kSlope_s) ++from;
    while (to + 1 < samples_.size() &&
           ToSeconds(samples_[to + 1].stamp - sample.stamp) <= kSlope_s) {
      ++to;
    }
    const double span_s = ToSeconds(samples_[to].stamp - samples_[from].stamp);
    if (span_s > 0.0) {
      sample.accel_mps2 = (samples_[to].speed_mps - samples_[from].speed_mps) / span_s;
      sample.yaw_accel_radps2 =
          (samples_[to].yaw_rate_radps - samples_[from].yaw_rate_radps) / span_s;
    }
    if (i == 0) continue;
    const Sample& last = samples_[i - 1];
    const double dt_s = ToSeconds(sample.stamp - last.stamp);
    const double turn_rad = 0.5 * dt_s * (last.yaw_rate_radps + sample.yaw_rate_radps);
    const double way_m = 0.5 * dt_s * (last.speed_mps + sample.speed_mps);
    sample.yaw_rad = last.yaw_rad + turn_rad;
    sample.x_m = last.x_m + way_m * std::cos(last.yaw_rad + 0.5 * turn_rad);
    sample.y_m = last.y_m + way_m * std::sin(last.yaw_rad + 0.5 * turn_rad);
  }
}

std::optional<std::size_t> EgoTrack::Nearest(Timestamp t) const {
  const auto after = std::ranges::lower_bound(samples_, t, {}, &Sample::stamp);
  auto best = after;
  if (after == samples_.end() ||
      (after != samples_.begin() && t - std::prev(after)->stamp < after->stamp - t)) {
    if (after == samples_.begin()) return std::nullopt;
    best = std::prev(after);
  }
  if (std::abs(ToSeconds(t - best->stamp)) > kNear_s) return std::nullopt;
  return static_cast<std::size_t>(best - samples_.begin());
}

std::optional<EgoTrack::Place> EgoTrack::At(Timestamp t) const {
  const auto nearest = Nearest(t);
  if (!nearest) return std::nullopt;
  const Sample& sample = samples_[*nearest];
  const double dt_s = ToSeconds(t - sample.stamp);
  const double turn_rad = dt_s * sample.yaw_rate_radps;
  const double way_m = dt_s * (sample.speed_mps + 0.5 * dt_s * sample.accel_mps2);
  return Place{sample.x_m + way_m * std::cos(sample.yaw_rad + 0.5 * turn_rad),
               sample.y_m + way_m * std::sin(sample.yaw_rad + 0.5 * turn_rad),
               sample.yaw_rad + turn_rad};
}

}  // namespace v2vouch
