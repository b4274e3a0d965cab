// SPDX-License-Identifier: Apache-2.0
#include "sim/evaluation/sight.h"

#include <algorithm>
#include <string_view>

namespace v2vouch::evaluation {

double DetectionProbability(const TruthSample& sample, const SensorSpec& sensor) {
  const std::string_view channel = sensor.channel;
  const std::string_view bare = channel.substr(channel.find('_') + 1);
  const TruthLook* found = nullptr;
  for (const TruthLook& look : sample.looks) {
    if (look.sensor == channel) return look.detection_probability;
    if (look.sensor != bare) continue;
    if (found == nullptr || !sensor.is_radar) found = &look;
  }
  return found == nullptr ? 0.0 : std::clamp(found->detection_probability, 0.0, 1.0);
}

bool IsSeenByBoth(const TruthSample& sample, const SceneSpecs& specs) {
  const auto sees = [&](bool by_radar) {
    return std::ranges::any_of(specs.sensors, [&](const SensorSpec& sensor) {
      return sensor.is_radar == by_radar && DetectionProbability(sample, sensor) >= kSeeing;
    });
  };
  return sees(true) && sees(false);
}

}  // namespace v2vouch::evaluation
