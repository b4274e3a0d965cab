// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/placing.h"

namespace v2vouch::evaluation {

std::vector<PlacedTrack> PlaceTracks(const RunLog& log, const ReceivedList* list, ListKind kind,
                                     Timestamp t) {
  std::vector<PlacedTrack> placed;
  if (list == nullptr) return placed;
  const auto X_WB = log.truth.EgoPose(list->stamp);
  if (!X_WB) return placed;
  for (const ListedTrack& track : list->tracks) {
    const bool is_vehicle = track.object_class != 6 && track.object_class != 7;
    if (kind == ListKind::kLocal && !is_vehicle) continue;
    PlanarMotion motion = track.motion_B;
    const Point<World> p = *X_WB * Point<Body>{motion.x_m, motion.y_m};
    motion.x_m = p.x_m;
    motion.y_m = p.y_m;
    motion.yaw_rad += X_WB->yaw_rad();
    const Eigen::Matrix2d R_WB = X_WB->rotation();
    placed.push_back({&track, Predict(motion, ToSeconds(t - list->stamp)),
                      R_WB * track.position_covariance_B * R_WB.transpose()});
  }
  return placed;
}

}  // namespace v2vouch::evaluation
