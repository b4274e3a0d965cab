// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/priority/priority_vehicle.h"

#include <cmath>

namespace v2vouch {

void PriorityVehicle::PredictTo(Timestamp stamp, const PriorityFilterConfig& config) {
  filter.PredictTo(stamp, config);
  coast.PredictTo(stamp, config.motion);
  agreed.PredictTo(stamp, config.motion);
}

bool PriorityVehicle::CanReach(const Eigen::Vector2d& p_O, Timestamp now,
                               const BridgeConfig& config) const {
  const double elapsed_s = ToSeconds(now - last_support);
  return coast.Reaches(p_O, elapsed_s, config) || agreed.Reaches(p_O, elapsed_s, config);
}

KinematicState PriorityVehicle::StateAt(Timestamp at, const PriorityFilterConfig& config) const {
  KinematicState state = filter.kinematics();
  const double dt_s = ToSeconds(at - filter.stamp());
  if (dt_s >= 0.0) {
    PredictCtra(state, dt_s, config.motion);
  } else {
    // A claim came after the frame that is being published: back along the direction of travel.
    state.mean[kX] += state.mean[kSpeed] * dt_s * std::cos(state.mean[kYaw]);
    state.mean[kY] += state.mean[kSpeed] * dt_s * std::sin(state.mean[kYaw]);
  }
  return state;
}

std::uint64_t PriorityId(std::uint64_t local_id, int attempt) {
  std::uint64_t z = local_id + 0x9E3779B97F4A7C15ULL * static_cast<std::uint64_t>(attempt + 1);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  z ^= z >> 31;
  return (z >> 1) | 1;  // Never 0; fits a signed 64-bit field.
}

}  // namespace v2vouch
