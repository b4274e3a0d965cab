// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/sight.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace v2vouch::evaluation {

const char* SightingName(Sighting sighting) {
  switch (sighting) {
    case Sighting::kVisible:
      return "visible";
    case Sighting::kHidden:
      return "hidden";
    case Sighting::kOutOfView:
      break;
  }
  return "out of view";
}

Sighting TrueSighting(const TruthSample& sample, const PlanarMotion& motion,
                      const Pose<World, Body>& X_WB, const SceneSpecs& specs) {
  if (!sample.is_hidden) return Sighting::kVisible;
  const Eigen::Vector2d p_B = (X_WB.Inverse() * Point<World>{motion.x_m, motion.y_m}).vector();
  for (const SensorSpec& sensor : specs.sensors) {
    if (sensor.Covers(p_B)) return Sighting::kHidden;
  }
  return Sighting::kOutOfView;
}

double DetectionProbability(const TruthSample& sample, const SensorSpec& sensor) {
  const std::string_view channel = sensor.channel;
  const std::string_view bare = channel.substr(channel.find('_') + 1);
  const TruthLook* found = nullptr;
  for (const TruthLook& look : sample.looks) {
    if (look.sensor == channel) return look.detection_probability;
    if (look.sensor != bare) continue;
    if (found == nullptr || sensor.kind != SensorKind::kRadar) found = &look;
  }
  return found == nullptr ? 0.0 : std::clamp(found->detection_probability, 0.0, 1.0);
}

bool IsSeenByEnough(const TruthSample& sample, const SceneSpecs& specs) {
  const auto sees = [&](SensorKind kind) {
    return std::ranges::any_of(specs.sensors, [&](const SensorSpec& sensor) {
      return sensor.kind == kind && DetectionProbability(sample, sensor) >= kSeeing;
    });
  };
  return std::ranges::count_if(kAllSensorKinds, sees) >= specs.KindsThatCheck();
}

}  // namespace v2vouch::evaluation
