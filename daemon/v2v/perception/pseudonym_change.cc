// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/pseudonym_change.h"

#include <Eigen/LU>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

constexpr double kSameSpeed_mps = 2.0;
constexpr double kSameYaw_rad = FromDegrees(20.0);

bool Fits(const PriorityVehicle& vehicle, const ClaimInOdometry& here,
          const PriorityConfig& config) {
  PriorityFilter ahead = vehicle.filter;
  ahead.PredictTo(here.stamp, config.filter);
  const KinematicState state = ahead.kinematics();
  const Eigen::Vector2d nu = here.p_O - state.mean.head<2>() - ahead.bias();
  const Eigen::Matrix2d S = state.covariance.topLeftCorner<2, 2>() + ahead.bias_covariance() +
                            here.noise + here.alignment;
  if (nu.dot(S.inverse() * nu) > config.identity_change.gate) return false;
  if (std::abs(here.speed_mps - state.mean[kSpeed]) > kSameSpeed_mps) return false;
  return !here.has_course || std::abs(state.mean[kSpeed]) <= kSameSpeed_mps ||
         std::abs(AngleDifference(here.yaw_rad, state.mean[kYaw])) <= kSameYaw_rad;
}

}  // namespace

PriorityVehicle* FindContested(PriorityList& list, SenderId sender, Timestamp now,
                               const IdentityChangeConfig& config) {
  for (PriorityVehicle& vehicle : list.vehicles()) {
    if (vehicle.has_ended() || vehicle.predecessor != sender) continue;
    if (ToSeconds(now - vehicle.handover) <= config.contest_s) return &vehicle;
  }
  return nullptr;
}

PriorityVehicle* FindContinued(PriorityList& list, SenderRecord& record,
                               const ClaimInOdometry& here, const PriorityConfig& config) {
  if (record.trust.has_penalty()) return nullptr;
  const IdentityChangeConfig& change = config.identity_change;
  PriorityVehicle* continued = nullptr;
  for (PriorityVehicle& vehicle : list.vehicles()) {
    const double silence_s = ToSeconds(here.stamp - vehicle.last_v2v);
    if (vehicle.has_ended() || record.first_heard <= vehicle.last_v2v ||
        silence_s < change.least_silence_s || silence_s > change.most_silence_s ||
        !Fits(vehicle, here, config)) {
      continue;
    }
    if (continued != nullptr) return nullptr;  // Two could be meant: neither is taken.
    continued = &vehicle;
  }
  if (continued == nullptr) {
    record.continues_id = 0;
    record.continues_claims = 0;
    return nullptr;
  }
  record.continues_claims = record.continues_id == continued->id ? record.continues_claims + 1 : 1;
  record.continues_id = continued->id;
  if (record.continues_claims < change.messages) return nullptr;
  record.continues_id = 0;
  return continued;
}

}  // namespace v2vouch
