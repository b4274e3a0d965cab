// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/placing.h"

#include <Eigen/LU>
#include <limits>

namespace v2vouch::evaluation {
namespace {

bool IsInScope(const TruthObject& object, ListKind kind, Against against) {
  if (!object.is_vehicle()) return false;
  return against == Against::kAllVehicles || kind == ListKind::kLocal || object.has_v2v;
}

}  // namespace

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

std::vector<PlacedTruth> PlaceTruths(const RunLog& log, ListKind kind, Against against, Timestamp t,
                                     const Pose<World, Body>& X_WB) {
  std::vector<PlacedTruth> truths;
  for (std::size_t o = 0; o < log.truth.objects.size(); ++o) {
    const TruthObject& object = log.truth.objects[o];
    if (!IsInScope(object, kind, against)) continue;
    const auto motion = object.motion.At(t);
    if (!motion) continue;
    truths.push_back(
        {o, motion->position(), TrueSighting(*object.motion.InForce(t), *motion, X_WB, log.specs)});
  }
  return truths;
}

bool IsBesideRoadUser(const Truth& truth, const Eigen::Vector2d& p_W, Timestamp t, double reach_m) {
  for (const TruthObject& object : truth.objects) {
    if (object.is_vehicle()) continue;
    const auto motion = object.motion.At(t);
    if (motion && (motion->position() - p_W).norm() < reach_m) return true;
  }
  return false;
}

double NeesAt(const RunLog& log, const TruthObject& object, const ReceivedList& list,
              const ListedTrack& track) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto X_WB = log.truth.EgoPose(list.stamp);
  const auto truth = object.motion.At(list.stamp);
  if (!X_WB || !truth) return kNone;
  const Point<Body> p_B = X_WB->Inverse() * Point<World>{truth->x_m, truth->y_m};
  const Eigen::Vector2d error = p_B.vector() - track.motion_B.position();
  const Eigen::Matrix2d& P = track.position_covariance_B;
  if (!(P.allFinite() && P(0, 0) > 0.0 && P.determinant() > 0.0)) return kNone;
  return error.dot(P.inverse() * error);
}

}  // namespace v2vouch::evaluation
