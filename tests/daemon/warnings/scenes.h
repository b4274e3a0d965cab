// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/angle.h"
#include "daemon/warnings/warner.h"

namespace v2vouch::warnings {

inline const Timestamp kStart = FromMicros(1'781'510'400'000'000);

/// In O, with the ego at its origin unless a test moves it.
inline Target Car(std::int64_t local_id, double x, double y, double yaw, double speed) {
  Target target;
  target.local_id = local_id;
  target.state_O.mean << x, y, yaw, speed, 0.0, 0.0;
  target.state_O.covariance = StateMatrix::Zero();
  target.state_O.covariance.diagonal() << 0.02, 0.02, 1e-4, 0.02, 1e-5, 0.04;
  target.extent = {4.0, 1.7, 0.2, 0.1};
  target.last_own = kStart;
  return target;
}

/// The same vehicle as PRIORITY has it.
inline Target Vouched(Target target, std::int64_t track_id, Visibility visibility) {
  target.track_id = track_id;
  target.source = Source::kPriority;
  target.visibility = visibility;
  if (visibility != Visibility::kVisible) target.local_id = 0;
  target.bridge_budget_s = 5.0;
  return target;
}

inline EgoReading Driving(double speed, double yaw_rate = 0.0, double accel = 0.0) {
  return {kStart, speed, 0.03, yaw_rate, 0.001, accel};
}

inline Scene SceneOf(const EgoReading& ego, std::vector<Target> targets,
                     std::optional<TurnSignal> signal = std::nullopt) {
  Scene scene;
  scene.now = kStart;
  scene.ego = ego;
  scene.targets = std::move(targets);
  if (signal) {
    scene.intent.emplace();
    scene.intent->turn_signal = *signal;
  }
  return scene;
}

inline std::vector<SectorHealth> AllRound() {
  return {{-kPi, kPi - 1e-3, 100.0, SectorState::kWatched}};
}

}  // namespace v2vouch::warnings
