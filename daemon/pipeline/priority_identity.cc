// SPDX-License-Identifier: Apache-2.0
// Whose a claim is: one id that two devices use, and one device that changes its id.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "daemon/base/angle.h"
#include "daemon/pipeline/priority_perception.h"

namespace v2vouch {
namespace {

constexpr double kHeirSpeed_mps = 2.0;
constexpr double kHeirYaw_rad = FromDegrees(20.0);

}  // namespace

// A claim far from where the sensors see its sender, between others that fit: an id that two
// devices use. The vehicle goes on by the claims that fit; a lasting departure is the sender's own.
bool PriorityPerception::IsSomebodyElses(Link& link, const PriorityVehicle* vehicle,
                                         const ClaimInOdometry& here) {
  const TrustConfig& config = settings_->priority.trust;
  if (vehicle == nullptr || !vehicle->is_supported || !link.trust.is_relied_on()) return false;
  const ResidualHistory& history = link.trust.history();
  const auto sensed = SensedAt(vehicle->local_id, here.stamp);
  if (!sensed || !history.is_settled()) return false;
  const Eigen::Vector2d off_O = here.p_O - sensed->mean.head<2>() - history.mean_O();
  const double limit_m = config.odd_claim_m + 2.0 * std::sqrt(0.5 * here.noise.trace()) +
                         config.stale_position_s * std::abs(sensed->mean[kSpeed]);
  if (off_O.norm() <= limit_m) {
    link.odd_claims = 0;
    return false;
  }
  return ++link.odd_claims < config.odd_claims;
}

// An honest change of pseudonym: a new id goes on where an old one has just fallen silent.
PriorityVehicle* PriorityPerception::Inherit(Link& link, const ClaimInOdometry& here,
                                             Outputs& outputs) {
  const PriorityConfig& config = settings_->priority;
  const IdentityChangeConfig& change = config.identity_change;
  // The old id speaks again: then it was no change, and the newcomer is thrown out.
  for (PriorityVehicle& vehicle : vehicles_) {
    if (vehicle.id == 0 || vehicle.predecessor != link.sender) continue;
    if (ToSeconds(here.stamp - vehicle.handover) > change.contest_s) continue;
    Link* rival = FindLink(vehicle.sender);
    vehicle.predecessor.reset();
    if (rival == nullptr) continue;
    link.trust.InheritFrom(rival->trust);
    vehicle.sender = link.sender;
    pairs_.SetIncumbent(rival->sender, std::nullopt);
    pairs_.SetIncumbent(link.sender, vehicle.local_id);
    rival->trust.OnFinding(here.stamp,
                           {"contested_identity", Verdict::kWithdraw, "silence_s",
                            ToSeconds(here.stamp - vehicle.handover), change.contest_s},
                           MayAccuse(here.stamp));
    Report(*rival, here.stamp, outputs);
    return &vehicle;
  }
  if (link.trust.has_penalty()) return nullptr;

  PriorityVehicle* heritage = nullptr;
  for (PriorityVehicle& vehicle : vehicles_) {
    const double silence_s = ToSeconds(here.stamp - vehicle.last_v2v);
    if (vehicle.id == 0 || silence_s < change.least_silence_s ||
        silence_s > change.most_silence_s) {
      continue;
    }
    PriorityFilter ahead = vehicle.filter;
    ahead.PredictTo(here.stamp, config.filter);
    const KinematicState state = ahead.kinematics();
    const Eigen::Vector2d nu = here.p_O - state.mean.head<2>() - ahead.bias();
    const Eigen::Matrix2d S = state.covariance.topLeftCorner<2, 2>() + ahead.bias_covariance() +
                              here.noise + here.alignment;
    if (nu.dot(S.inverse() * nu) > change.gate) continue;
    if (std::abs(here.speed_mps - state.mean[kSpeed]) > kHeirSpeed_mps) continue;
    if (here.has_course && std::abs(state.mean[kSpeed]) > kHeirSpeed_mps &&
        std::abs(AngleDifference(here.yaw_rad, state.mean[kYaw])) > kHeirYaw_rad) {
      continue;
    }
    if (heritage != nullptr) return nullptr;  // Two could be meant: neither is taken.
    heritage = &vehicle;
  }
  if (heritage == nullptr) {
    link.heir_of = 0;
    link.heir_claims = 0;
    return nullptr;
  }
  link.heir_claims = link.heir_of == heritage->id ? link.heir_claims + 1 : 1;
  link.heir_of = heritage->id;
  if (link.heir_claims < change.messages) return nullptr;
  const SenderId heir = link.sender;
  const SenderId old = heritage->sender;
  if (const Link* old_link = FindLink(old)) link.trust.InheritFrom(old_link->trust);
  link.heir_of = 0;
  heritage->predecessor = old;
  heritage->handover = here.stamp;
  heritage->sender = heir;
  pairs_.DropSender(old);
  pairs_.SetIncumbent(heir, heritage->local_id);
  std::erase_if(links_, [&](const Link& other) { return other.sender == old; });
  return heritage;
}

}  // namespace v2vouch
