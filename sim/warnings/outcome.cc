// SPDX-License-Identifier: Apache-2.0
#include "sim/warnings/outcome.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace v2vouch::evaluation {
namespace {

constexpr Duration kStep{50'000};
constexpr double kBeyond_s = 3.0;

// The ego's true way by length, straight on behind its end.
class Way {
 public:
  explicit Way(const Truth& truth) : samples_(truth.ego.samples()) {
    along_m_.push_back(0.0);
    for (std::size_t i = 1; i < samples_.size(); ++i) {
      along_m_.push_back(
          along_m_.back() +
          (samples_[i].motion.position() - samples_[i - 1].motion.position()).norm());
    }
  }
  [[nodiscard]] double AlongAt(Timestamp t) const {
    const TruthSample& last = samples_.back();
    if (t >= last.stamp) {
      return along_m_.back() +
             (Predict(last.motion, ToSeconds(t - last.stamp)).position() - last.motion.position())
                 .norm();
    }
    const auto after = std::ranges::upper_bound(samples_, t, {}, &TruthSample::stamp);
    if (after == samples_.begin()) return 0.0;
    const auto i = static_cast<std::size_t>(after - samples_.begin());
    const double share =
        ToSeconds(t - samples_[i - 1].stamp) / ToSeconds(samples_[i].stamp - samples_[i - 1].stamp);
    return along_m_[i - 1] + share * (along_m_[i] - along_m_[i - 1]);
  }
  [[nodiscard]] PlanarMotion At(double along_m) const {
    const auto after = std::ranges::lower_bound(along_m_, along_m);
    if (after == along_m_.end()) {
      PlanarMotion last = samples_.back().motion;
      const double on_m = along_m - along_m_.back();
      last.x_m += on_m * std::cos(last.yaw_rad);
      last.y_m += on_m * std::sin(last.yaw_rad);
      return last;
    }
    const auto i = static_cast<std::size_t>(after - along_m_.begin());
    if (i == 0) return samples_.front().motion;
    const double leg_m = along_m_[i] - along_m_[i - 1];
    const double share = leg_m > 1e-9 ? (along_m - along_m_[i - 1]) / leg_m : 0.0;
    PlanarMotion at = samples_[i - 1].motion;
    const PlanarMotion& next = samples_[i].motion;
    at.x_m += share * (next.x_m - at.x_m);
    at.y_m += share * (next.y_m - at.y_m);
    at.yaw_rad += share * std::remainder(next.yaw_rad - at.yaw_rad, 2.0 * 3.14159265358979);
    return at;
  }

 private:
  const std::vector<TruthSample>& samples_;
  std::vector<double> along_m_;
};

std::optional<PlanarMotion> ObjectAt(const TruthObject& object, Timestamp t, Timestamp end) {
  if (t <= end) return object.motion.At(t);
  const auto last = object.motion.At(end);
  if (!last) return std::nullopt;
  return Predict(*last, ToSeconds(t - end));
}

}  // namespace

Outcome Simulate(const Truth& truth, const warnings::EgoBody& body, std::optional<Timestamp> warned,
                 const Braking& braking) {
  const Way way(truth);
  const Timestamp last = truth.end() + FromSeconds(kBeyond_s);
  const warnings::HalfSize half{0.5 * body.length_m, 0.5 * body.width_m};
  std::optional<Timestamp> brakes;
  if (warned) brakes = *warned + FromSeconds(braking.after_s);
  Outcome outcome;
  double along_m = 0.0;
  double speed_mps = 0.0;
  const double dt_s = ToSeconds(kStep);
  for (Timestamp t = truth.begin(); t <= last; t += kStep) {
    const double true_speed = (way.AlongAt(t + kStep) - way.AlongAt(t)) / dt_s;
    if (!brakes || t < *brakes) {
      along_m = way.AlongAt(t);
      speed_mps = true_speed;
    } else {
      const double before_mps = speed_mps;
      speed_mps = std::max(0.0, speed_mps - braking.decel_mps2 * dt_s);
      along_m += 0.5 * (before_mps + speed_mps) * dt_s;
      outcome.speed_lost_mps = std::max(outcome.speed_lost_mps, true_speed - speed_mps);
    }
    const PlanarMotion ego = way.At(along_m);
    const warnings::Box box{ego.position() + body.centre_x_m * ego.direction(), ego.direction()};
    for (const TruthObject& object : truth.objects) {
      const auto motion = ObjectAt(object, t, truth.end());
      if (!motion || speed_mps < 0.1) continue;
      const Eigen::Vector2d between = motion->position() - box.centre;
      if (between.dot(box.along) < 0.0) continue;
      const warnings::Box other{motion->position(), motion->direction()};
      if (!warnings::Touch(box, half, other, {0.5 * object.length_m, 0.5 * object.width_m})) {
        continue;
      }
      outcome.has_contact = true;
      outcome.contact = t;
      outcome.contact_speed_mps = speed_mps;
      return outcome;
    }
  }
  return outcome;
}

}  // namespace v2vouch::evaluation
