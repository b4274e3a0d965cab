// SPDX-License-Identifier: Apache-2.0
// Blocks that change what is said of speed, heading, acceleration, size and accuracy.
#include <limits>
#include <utility>

#include "sim/attacks/change.h"

namespace v2vouch::sim {

void Change::Alter(const SpeedChangeSpec& spec, const Moment&, Message& message) {
  double& speed = message.said.speed_mps;
  speed *= spec.scale;
  if (spec.set_mps) speed = *spec.set_mps;
  if (IsToBeDrawn(spec.draw)) {
    const double anything = random_.Uniform(0.0, spec.random_to_mps);
    const double more = random_.Uniform(spec.low_mps, spec.high_mps);
    drawn_ = random_.Bernoulli(0.5) ? more : -more;
    drawn_place_.x() = anything;
  }
  if (spec.random_to_mps > 0.0) speed = drawn_place_.x();
  speed += drawn_;
}

void Change::Alter(const HeadingChangeSpec& spec, const Moment& now, Message& message) {
  message.said.yaw_rad += spec.add_rad + spec.per_message_rad * (now.number + 1);
}

void Change::Alter(const AccelerationChangeSpec& spec, const Moment&, Message& message) {
  if (IsToBeDrawn(spec.draw)) {
    drawn_ = random_.Uniform(spec.low_scale, spec.high_scale);
  }
  message.said.accel_mps2 *= drawn_;
  if (spec.set_mps2) message.said.accel_mps2 = *spec.set_mps2;
  using Lights = AccelerationChangeSpec::Lights;
  if (spec.brakes == Lights::kOn) message.said.brakes = Brakes::kOn;
  if (spec.brakes == Lights::kOff) message.said.brakes = Brakes::kOff;
}

void Change::Alter(const SizeChangeSpec& spec, const Moment&, Message& message) {
  constexpr double kSmallest = 0.3;
  double factor = spec.scale;
  if (spec.random_to > 0.0) factor *= random_.Uniform(kSmallest, spec.random_to);
  Statement& said = message.said;
  if (spec.swap) std::swap(said.length_m, said.width_m);
  said.length_m *= factor;
  said.width_m *= factor;
}

void Change::Alter(const AccuracySpec& spec, const Moment&, Message& message) {
  message.said.semi_major_m =
      spec.unavailable ? std::numeric_limits<double>::quiet_NaN() : spec.semi_major_m;
}

}  // namespace v2vouch::sim
