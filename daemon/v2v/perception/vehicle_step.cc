// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/vehicle_step.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "daemon/common/models/measurement_model.h"
#include "daemon/v2v/perception/claimed_size.h"
#include "daemon/v2v/perception/evidence.h"
#include "daemon/v2v/perception/reappearance.h"
#include "daemon/v2v/trust/checks.h"

namespace v2vouch {
namespace {

// The PRIORITY filter is never allowed this far from a LOCAL track that is being seen.
constexpr double kApart_m = 0.7;
// A bridge is explained by a track, but not from the next lane.
constexpr double kMostSlack_m = 1.0;
// The part of a moving vehicle that something begins to cover drags its track along; its own
// motion and the sender's bias are known from before.
constexpr double kPartNoise = 100.0;
constexpr double kMoving_mps = 1.0;
constexpr double kMostBias = 0.95;  // Of what a bias may be: the filter stops there.

Occluder FootprintOfVehicle(const PriorityVehicle& vehicle) {
  return {.id = vehicle.local_id,
          .centre_O = vehicle.filter.mean().head<2>(),
          .yaw_rad = vehicle.filter.mean()[kYaw],
          .length_m = vehicle.extent.length_m,
          .width_m = vehicle.extent.width_m,
          .position_sigma_m = vehicle.filter.position_sigma_m()};
}

Visibility SeenAs(View view) {
  switch (view) {
    case View::kOccluded:
      return Visibility::kHidden;
    case View::kOutOfView:
      return Visibility::kOutOfView;
    default:
      return Visibility::kVisible;
  }
}

// How a measurement of the LOCAL track looks to the PRIORITY filter's own state.
std::optional<Linearized> Linearize(const SensorMeasurement& measurement, const StateVector& x,
                                    const Extent& extent, const EgoState& ego,
                                    const VehicleConfig& vehicle) {
  if (const auto* radar = std::get_if<RadarMeasurement>(&measurement)) {
    return LinearizeRadar(x, extent, ego, vehicle.radars[static_cast<std::size_t>(radar->radar)],
                          *radar);
  }
  if (const auto* camera = std::get_if<CameraMeasurement>(&measurement)) {
    return LinearizeCamera(x, extent, ego,
                           vehicle.cameras[static_cast<std::size_t>(camera->camera)], *camera);
  }
  if (const auto* box = std::get_if<BoxMeasurement>(&measurement)) return LinearizeBox(x, *box);
  return std::nullopt;
}

void TakeMeasurements(const V2vView& view, PriorityVehicle& vehicle, const TrackSnapshot& seen,
                      const LocalFrame& frame) {
  const LocalTrack track =
      GivenClaimedSize(seen.track, view.senders.Find(vehicle.sender), view.config.trust);
  vehicle.extent = track.extent;
  const Extent extent = track.ModelExtent();
  for (const SensorUpdate& update : frame.updates) {
    if (update.track_id != track.id) continue;
    const StateVector x = vehicle.filter.kinematics().mean;
    auto linear = Linearize(update.measurement, x, extent, frame.ego, view.vehicle);
    if (!linear) continue;
    if (seen.is_briefly_partial && std::abs(x[kSpeed]) > kMoving_mps) linear->R *= kPartNoise;
    vehicle.filter.Update(*linear);
  }
  vehicle.support = track.support;
  if (track.object_class != ObjectClass::kUnknown) vehicle.object_class = track.object_class;
  if (!vehicle.is_supported) return;
  vehicle.existence = track.existence;
  vehicle.last_support = frame.stamp;
  vehicle.coast = Coast(track.state_O, frame.stamp);
  vehicle.empty.OnHit();
  // V2V never moves a vehicle that the sensors see: where the two have come apart, LOCAL is right.
  const Eigen::Vector2d apart = vehicle.filter.mean().head<2>() - track.state_O.mean.head<2>();
  if (apart.norm() > kApart_m + 4.0 * PositionSigma(track.state_O)) {
    vehicle.filter.ResetVehicle(track.state_O);
  }
  // Where the reflecting point lies on the vehicle is the sensors' lasting error; LOCAL carries it
  // with the size, and no claim can separate it from the sender's bias. During a partial
  // observation the filter keeps what it knew of the complete vehicle, or the part would drag it
  // along; the uncertainty is still published.
  const Eigen::Matrix2d P = track.state_O.covariance.topLeftCorner<2, 2>();
  if (!seen.is_partial) vehicle.filter.WidenPosition(P);
  vehicle.lasting = vehicle.filter.LackOf(P);
  vehicle.lasting_variance_m2 = track.lasting_variance_m2;
  vehicle.agreed = Coast(vehicle.filter.kinematics(), frame.stamp);
}

// Check empty_place for a bridged vehicle: is the position where we carry it seen to be empty?
void ObserveCarriedPosition(const V2vView& view, PriorityVehicle& vehicle, const LocalFrame& frame,
                            const VisibilityMap& map) {
  const Occluder footprint = FootprintOfVehicle(vehicle);
  // Anything there, even a track too young to be confirmed, means that it is not empty; but not a
  // vehicle in the next lane, nor one that is another sender's.
  const double slack_m = std::min(2.0 * footprint.position_sigma_m, kMostSlack_m);
  for (const LocalTrack& track : frame.tracks) {
    if (!track.support.IsHitAt(frame.stamp) || !AreClose(footprint, track, slack_m)) continue;
    if (!IsAnothers(view, track.id, vehicle.sender)) return;
  }
  const BridgeConfig& config = view.config.bridge;
  if (const auto probability = ClearDetection(footprint, frame, map, view.vehicle,
                                              ClearTo::kAnySensor, config.least_detection)) {
    vehicle.empty.OnMiss(frame.stamp, *probability, config);
  } else {
    vehicle.empty.OnCovered();
  }
}

bool IsBridgeOver(const V2vView& view, const PriorityVehicle& vehicle, const LocalFrame& frame) {
  const BridgeConfig& config = view.config.bridge;
  const Eigen::Vector2d p_O = vehicle.filter.mean().head<2>();
  // An empty position may be our own error: what the sender claims is judged beside, and blamed
  // where it is empty, too.
  return vehicle.empty.log_ratio() <= config.empty_log_ratio ||
         ToSeconds(frame.stamp - vehicle.last_v2v) >= config.max_gap_s ||
         vehicle.BudgetLeft_s(frame.stamp, config) <= 0.0 ||
         vehicle.filter.position_sigma_m() >= config.max_sigma_m ||
         (p_O - frame.ego.X_OB.origin().vector()).norm() >= config.max_distance_m ||
         // The sensors see another vehicle of the list there: both are one, or this one went
         // astray.
         view.list.HasAnotherAt(p_O, vehicle.sender, true);
}

void BeginBridge(PriorityVehicle& vehicle) {
  vehicle.is_supported = false;
  vehicle.regained_hits = 0;
  vehicle.regaining_id = 0;
  vehicle.elsewhere_id = 0;
  vehicle.velocity_doubts = 0;
  vehicle.empty = {};
}

}  // namespace

VehicleStep StepVehicle(const V2vView& view, PriorityVehicle& vehicle, const LocalFrame& frame,
                        const VisibilityMap& map) {
  const BridgeConfig& config = view.config.bridge;
  VehicleStep step;
  const auto end = [&step] {
    step.action = VehicleAction::End();
    return step;
  };
  vehicle.PredictTo(frame.stamp, view.config.filter);

  const TrackSnapshot* seen = view.tracks.Find(vehicle.local_id);
  if (seen == nullptr && vehicle.local_id != 0) {
    vehicle.former_local_id = vehicle.local_id;
    vehicle.local_id = 0;
  }
  // The LOCAL track of a hidden vehicle may have switched to what hides it.
  if (seen != nullptr && seen->is_hit &&
      (vehicle.is_supported ||
       (!seen->is_partial && IsWhereClaimed(view, seen->track, vehicle, frame.stamp)))) {
    TakeMeasurements(view, vehicle, *seen, frame);
  }
  if (vehicle.is_supported && ToSeconds(frame.stamp - vehicle.last_support) > config.support_s) {
    // Sensors and sender had come apart by more than any bias: there is nothing to carry on.
    const double most_m = kMostBias * view.config.filter.max_bias_m;
    if (vehicle.filter.bias().norm() > most_m) return end();
    // A sender that was leaving its vehicle would take the bridge along.
    const SenderRecord* record = view.senders.Find(vehicle.sender);
    if (record != nullptr && IsWalkingOff(record->trust.history(), view.config.trust)) return end();
    // Nor does a bridge begin on a sender that has reported poor accuracy for a while: nothing has
    // confirmed it since.
    if (record != nullptr && ToSeconds(frame.stamp - record->last.stamp) > config.max_gap_s) {
      return end();
    }
    BeginBridge(vehicle);
    step.is_lost = true;
  }
  if (!vehicle.filter.is_healthy()) {
    step.has_failed_numerics = true;
    return end();
  }
  if (vehicle.is_supported) {
    vehicle.visibility = Visibility::kVisible;
    const bool is_silent = ToSeconds(frame.stamp - vehicle.last_v2v) > config.max_silence_s;
    return is_silent ? end() : step;
  }

  vehicle.visibility = SeenAs(map.Overall(FootprintOfVehicle(vehicle)));
  step.has_reappeared = UpdateReappearance(view, vehicle, frame.stamp);
  if (step.has_reappeared) return step;
  if (const auto finding = FindSeenElsewhere(view, vehicle, frame.stamp)) {
    const TrackSnapshot* elsewhere = view.tracks.Find(vehicle.elsewhere_id);
    if (elsewhere != nullptr && elsewhere->is_doubtful) return end();
    step.action = VehicleAction::Blame(*finding);
    return step;
  }
  ObserveCarriedPosition(view, vehicle, frame, map);
  return IsBridgeOver(view, vehicle, frame) ? end() : step;
}

}  // namespace v2vouch
