// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/bridge_claim.h"

#include <algorithm>

#include "daemon/v2v/perception/reappearance.h"

namespace v2vouch {
namespace {

constexpr int kMostVelocityDoubts = 2;
constexpr double kSeldom_s = 0.5;        // A sender that leaves such gaps speaks seldom.
constexpr double kLongestLost_s = 10.0;  // A sender that does not know its place says nothing then.

// Where the position fits and the motion does not, the motion was last measured by a part of the
// vehicle, or the vehicle has braked or turned; where it can be is bounded all the same. One
// message of a sender that speaks seldom is enough: it would be carried far in a false direction.
// @return whether the bridge ends.
bool CountMisfits(PriorityVehicle& vehicle, bool fits, bool position_fits, double since_last_s,
                  const BridgeConfig& config) {
  const int more = since_last_s > kSeldom_s ? config.max_misfits : 1;
  vehicle.misfits_in_a_row = fits ? 0 : vehicle.misfits_in_a_row + more;
  if (vehicle.misfits_in_a_row < config.max_misfits || !position_fits) return false;
  vehicle.filter.DoubtVelocity();
  vehicle.misfits_in_a_row = 0;
  return ++vehicle.velocity_doubts > kMostVelocityDoubts;
}

VehicleAction KeepWithinReach(const SenderRecord& record, const PriorityVehicle& vehicle,
                              Timestamp stamp, const BridgeConfig& config) {
  const Eigen::Vector2d p_O = vehicle.filter.mean().head<2>();
  if (vehicle.CanReach(p_O, stamp, config)) return VehicleAction::GoOn();
  // The sensors see a vehicle there that is where its sender says.
  if (IsReappearing(vehicle, stamp, config)) return VehicleAction::GoOn();
  if (record.breaks == 0) return VehicleAction::End();
  return VehicleAction::Blame({Check::kOutOfReach, Verdict::kWithdraw, "distance_m",
                               (p_O - vehicle.coast.state().mean.head<2>()).norm(), 0.0});
}

}  // namespace

VehicleAction UseClaim(const SenderRecord& record, PriorityVehicle& vehicle,
                       const ClaimInOdometry& here, const PriorityConfig& config) {
  if (!record.trust.is_relied_on()) return VehicleAction::GoOn();
  const double since_last_s = ToSeconds(here.stamp - vehicle.last_v2v);
  vehicle.PredictTo(here.stamp, config.filter);
  const ClaimFit fit = vehicle.filter.Update(here, config.filter);
  vehicle.last_v2v = here.stamp;
  vehicle.events = here.events;
  if (vehicle.is_supported) {
    vehicle.misfits_in_a_row = 0;  // Sensors judge it by its raw residual.
    if (fit.is_used) {
      vehicle.co_observed_s += std::clamp(since_last_s, 0.0, config.bridge.max_gap_s);
    }
    return VehicleAction::GoOn();
  }
  if (CountMisfits(vehicle, fit.is_used && fit.is_velocity_used, fit.is_used, since_last_s,
                   config.bridge)) {
    return VehicleAction::End();
  }
  if (vehicle.misfits_in_a_row < config.bridge.max_misfits) {
    return KeepWithinReach(record, vehicle, here.stamp, config.bridge);
  }
  // While a sender's messages continue each other, what does not fit may be what we carried: the
  // last frame had only a part of the vehicle, or the vehicle has turned. Then the bridge just
  // ends.
  if (record.breaks == 0) return VehicleAction::End();
  return VehicleAction::Blame({Check::kBridgeMisfit, Verdict::kWithdraw, "position_nis",
                               fit.position_nis, config.filter.position_gate});
}

VehicleAction UseMotion(const SenderRecord& record, PriorityVehicle& vehicle,
                        const ClaimInOdometry& here, const PriorityConfig& config) {
  if (!record.trust.is_relied_on()) return VehicleAction::GoOn();
  if (ToSeconds(here.stamp - record.last.stamp) > kLongestLost_s) return VehicleAction::End();
  vehicle.PredictTo(here.stamp, config.filter);
  const double since_last_s = ToSeconds(here.stamp - vehicle.last_v2v);
  const bool is_used = vehicle.filter.UpdateMotion(here, config.filter);
  vehicle.last_v2v = here.stamp;
  vehicle.events = here.events;
  if (vehicle.is_supported) return VehicleAction::GoOn();
  if (CountMisfits(vehicle, is_used, true, since_last_s, config.bridge)) {
    return VehicleAction::End();
  }
  return KeepWithinReach(record, vehicle, here.stamp, config.bridge);
}

}  // namespace v2vouch
