// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/odometry/odometry.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

// Where a car starting at the origin along x is after `t`, at constant turn rate and acceleration:
//
//     integral of (v + a s) [cos(w s), sin(w s)] ds, s from 0 to t
//
// With theta = w t this is v t [f1, f2] + a t^2 [g1, g2].
Pose<Body, Body> Arc(double speed_mps, double accel_mps2, double yaw_rate_radps, double t) {
  const double theta = yaw_rate_radps * t;
  const double theta2 = theta * theta;
  double f1, f2, g1, g2;
  if (std::abs(theta) < 1e-2) {  // Series: the closed forms lose digits to cancellation here.
    f1 = 1.0 - theta2 / 6.0 * (1.0 - theta2 / 20.0);
    f2 = theta / 2.0 * (1.0 - theta2 / 12.0);
    g1 = 0.5 - theta2 / 8.0 * (1.0 - theta2 / 18.0);
    g2 = theta / 3.0 * (1.0 - theta2 / 10.0);
  } else {
    const double s = std::sin(theta);
    const double c = std::cos(theta);
    f1 = s / theta;
    f2 = (1.0 - c) / theta;
    g1 = s / theta - (1.0 - c) / theta2;
    g2 = s / theta2 - c / theta;
  }
  const double from_speed = speed_mps * t;
  const double from_accel = accel_mps2 * t * t;
  return {from_speed * f1 + from_accel * g1, from_speed * f2 + from_accel * g2, theta};
}

}  // namespace

double EgoOdometry::AccelerationFromSpeeds(Timestamp stamp, double speed_mps) const {
  // Speed noise of 0.1 m/s over one 10 ms step would read as 14 m/s^2; over 0.2 s as 0.7.
  constexpr double kBaseline_s = 0.2;
  for (std::size_t age = 0; age < held(); ++age) {
    const double elapsed_s = ToSeconds(stamp - Sample(age).stamp);
    if (elapsed_s > kMaxGap_s) break;
    if (elapsed_s >= kBaseline_s) return (speed_mps - Sample(age).speed_mps) / elapsed_s;
  }
  return 0.0;
}

double EgoOdometry::HeldYawRate(Timestamp stamp) const {
  constexpr double kFade_s = 0.5;
  if (count_ == 0) return 0.0;
  const double since_s = std::max(0.0, ToSeconds(stamp - Sample(0).stamp));
  return Sample(0).yaw_rate_radps * std::exp(-since_s / kFade_s);
}

void EgoOdometry::OnEgoMotion(const EgoMotion& sample, double gyro_offset_radps,
                              double speed_factor) {
  EgoState next;
  next.stamp = sample.stamp;
  next.speed_mps = sample.speed_mps;
  next.yaw_rate_radps = sample.has_yaw_rate ? sample.yaw_rate_radps : HeldYawRate(sample.stamp);
  next.speed_sigma_mps = sample.speed_sigma_mps;
  next.yaw_rate_sigma_radps = sample.yaw_rate_sigma_radps;
  next.gyro_offset_radps = gyro_offset_radps;
  next.speed_factor = speed_factor;
  if (count_ > 0) {
    const EgoState& last = Sample(0);
    if (next.stamp < last.stamp) return;
    if (next.stamp == last.stamp) {
      next.X_OB = last.X_OB;
      --count_;
    } else {
      const double t = ToSeconds(next.stamp - last.stamp);
      const double accel_mps2 = (next.speed_mps - last.speed_mps) / t;
      const double yaw_rate_radps = 0.5 * (last.yaw_rate_radps + next.yaw_rate_radps);
      next.X_OB = last.X_OB * Arc(last.speed_mps, accel_mps2, yaw_rate_radps, t);
    }
  }
  next.accel_mps2 =
      sample.accel_long_mps2.value_or(AccelerationFromSpeeds(next.stamp, next.speed_mps));
  history_[count_ % kHistory] = next;
  ++count_;
}

std::optional<EgoState> EgoOdometry::StateAt(Timestamp t, double max_gap_s) const {
  std::size_t age = 0;
  while (age < held() && Sample(age).stamp > t) ++age;
  if (age == held()) return std::nullopt;
  EgoState state = Sample(age);
  const double ahead_s = ToSeconds(t - state.stamp);
  if (ahead_s > max_gap_s) return std::nullopt;

  // A braking car stops and stays; it does not roll back.
  double moving_s = ahead_s;
  if (state.speed_mps * state.accel_mps2 < 0.0) {
    moving_s = std::min(ahead_s, -state.speed_mps / state.accel_mps2);
  }
  const bool stops = moving_s < ahead_s;
  state.X_OB = state.X_OB * Arc(state.speed_mps, state.accel_mps2, state.yaw_rate_radps, moving_s);
  state.speed_mps = stops ? 0.0 : state.speed_mps + state.accel_mps2 * ahead_s;
  if (stops) state.accel_mps2 = 0.0;
  state.stamp = t;
  return state;
}

std::optional<Timestamp> EgoOdometry::newest() const {
  if (count_ == 0) return std::nullopt;
  return Sample(0).stamp;
}

}  // namespace v2vouch
