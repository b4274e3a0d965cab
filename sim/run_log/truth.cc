// SPDX-License-Identifier: Apache-2.0
#include "sim/run_log/truth.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::evaluation {
namespace {

/// Cubic through (0, a) and (h, b) with slopes da and db, at u in [0, 1] of the way.
double Hermite(double a, double da, double b, double db, double h, double u) {
  const double u2 = u * u;
  const double u3 = u2 * u;
  return a * (2.0 * u3 - 3.0 * u2 + 1.0) + h * da * (u3 - 2.0 * u2 + u) +
         b * (3.0 * u2 - 2.0 * u3) + h * db * (u3 - u2);
}

double Linear(double a, double b, double u) { return a + (b - a) * u; }

}  // namespace

PlanarMotion Predict(const PlanarMotion& motion, double dt_s) {
  PlanarMotion out = motion;
  // Braking ends at rest; it does not become driving backwards.
  double accel = motion.accel_mps2;
  double moving_s = dt_s;
  if (dt_s > 0.0 && accel * motion.speed_mps < 0.0) {
    moving_s = std::min(dt_s, -motion.speed_mps / accel);
  }
  const double turn = motion.yaw_rate_radps * moving_s;
  const double way = motion.speed_mps * moving_s + 0.5 * accel * moving_s * moving_s;
  // The chord of an arc of length `way` that turns by `turn`. With changing speed the turn is not
  // spread evenly over the way; over the tenth of a second this serves, that is below a millimetre.
  const double half = 0.5 * turn;
  const double chord = std::abs(half) < 1e-6 ? way : way * std::sin(half) / half;
  out.x_m += chord * std::cos(motion.yaw_rad + half);
  out.y_m += chord * std::sin(motion.yaw_rad + half);
  out.yaw_rad = WrapAngle(motion.yaw_rad + turn);
  out.speed_mps += accel * moving_s;
  if (moving_s != dt_s) out.accel_mps2 = 0.0;
  return out;
}

void MotionSamples::Add(TruthSample sample) {
  if (!samples_.empty() && sample.stamp <= samples_.back().stamp) return;
  samples_.push_back(std::move(sample));
}

std::optional<std::size_t> MotionSamples::IndexAt(Timestamp t) const {
  const auto after = std::upper_bound(
      samples_.begin(), samples_.end(), t,
      [](Timestamp value, const TruthSample& sample) { return value < sample.stamp; });
  if (after == samples_.begin()) return std::nullopt;
  const auto index = static_cast<std::size_t>(after - samples_.begin()) - 1;
  if (samples_[index].stamp == t) return index;
  if (after == samples_.end() || after->stamp - samples_[index].stamp > kMaxGap) {
    return std::nullopt;
  }
  return index;
}

std::optional<PlanarMotion> MotionSamples::At(Timestamp t) const {
  const auto index = IndexAt(t);
  if (!index) return std::nullopt;
  const TruthSample& before = samples_[*index];
  if (before.stamp == t) return before.motion;
  const PlanarMotion& a = before.motion;
  const PlanarMotion& b = samples_[*index + 1].motion;
  const double h = ToSeconds(samples_[*index + 1].stamp - before.stamp);
  const double u = ToSeconds(t - before.stamp) / h;
  const Eigen::Vector2d va = a.speed_mps * a.direction();
  const Eigen::Vector2d vb = b.speed_mps * b.direction();
  PlanarMotion out;
  out.x_m = Hermite(a.x_m, va.x(), b.x_m, vb.x(), h, u);
  out.y_m = Hermite(a.y_m, va.y(), b.y_m, vb.y(), h, u);
  const double yaw_b = a.yaw_rad + AngleDifference(b.yaw_rad, a.yaw_rad);
  out.yaw_rad = WrapAngle(Hermite(a.yaw_rad, a.yaw_rate_radps, yaw_b, b.yaw_rate_radps, h, u));
  out.speed_mps = Linear(a.speed_mps, b.speed_mps, u);
  out.yaw_rate_radps = Linear(a.yaw_rate_radps, b.yaw_rate_radps, u);
  out.accel_mps2 = Linear(a.accel_mps2, b.accel_mps2, u);
  return out;
}

const TruthSample* MotionSamples::InForce(Timestamp t) const {
  const auto index = IndexAt(t);
  return index ? &samples_[*index] : nullptr;
}

std::optional<Pose<World, Body>> Truth::EgoPose(Timestamp t) const {
  const auto motion = ego.At(t);
  if (!motion) return std::nullopt;
  return Pose<World, Body>(motion->x_m, motion->y_m, motion->yaw_rad);
}

}  // namespace v2vouch::evaluation
