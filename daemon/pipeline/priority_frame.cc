// SPDX-License-Identifier: Apache-2.0
// What an own-sensor frame does to the PRIORITY vehicles: support, loss, return, contradiction.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <variant>

#include "daemon/base/angle.h"
#include "daemon/models/measurement_model.h"
#include "daemon/pipeline/priority_evidence.h"
#include "daemon/pipeline/priority_perception.h"

namespace v2vouch {
namespace {

constexpr double kReturnGate = 13.8;    // Chi-square, 2 dof, 0.999.
constexpr double kReturnFloor_m = 0.7;  // Extent and reference point of a young track.
constexpr double kReturnSpeed_mps = 4.0;
constexpr double kSlack_s = 0.5;     // A track born so long before the loss may still be its heir.
constexpr double kPatience_s = 0.5;  // Hits of a return may lie so far apart.
// A coast less certain than this contradicts nobody.
constexpr double kUsefulCoast_m = 4.0;
constexpr double kCoastGate = 9.21;
constexpr double kSameSpeed_mps = 3.0;
constexpr double kSameYaw_rad = FromDegrees(30.0);
// The PRIORITY filter is never allowed this far from a LOCAL track that is being seen.
constexpr double kApart_m = 0.7;

double GateDistance(const Eigen::Vector2d& d, const Eigen::Matrix2d& S) {
  return d.dot(S.inverse() * d);
}

double PositionSigma(const KinematicState& state) {
  return std::sqrt(std::max(state.covariance(kX, kX), state.covariance(kY, kY)));
}

// Hits from a camera alone come at its pace, so a missing hit in one frame means nothing.
bool IsFresh(const LocalTrack& track, Timestamp stamp) {
  return track.last_radar == stamp || track.last_camera == stamp;
}

Occluder FootprintOfVehicle(const PriorityVehicle& vehicle) {
  return {.id = vehicle.local_id,
          .centre_O = vehicle.filter.mean().head<2>(),
          .yaw_rad = vehicle.filter.mean()[kYaw],
          .length_m = vehicle.extent.length_m,
          .width_m = vehicle.extent.width_m,
          .position_sigma_m = vehicle.filter.position_sigma_m()};
}

bool IsInFullView(const SensorMeasurement& measurement, const BridgeConfig& config) {
  if (const auto* radar = std::get_if<RadarMeasurement>(&measurement)) {
    return radar->visible_share >= config.clear_share;
  }
  const auto& camera = std::get<CameraMeasurement>(measurement);
  return !camera.left_is_cut && !camera.right_is_cut;
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

}  // namespace

void PriorityPerception::Remember(const LocalFrame& frame, const VisibilityMap& map) {
  sensed_stamp_ = frame.stamp;
  sensed_.clear();
  for (const LocalTrack& track : frame.tracks) {
    if (!track.is_confirmed) continue;
    const bool is_hit =
        IsFresh(track, frame.stamp) ||
        std::ranges::find(frame.updates, track.id, &SensorUpdate::track_id) != frame.updates.end();
    // Coverage is asked for tracks that a sender may be; the question is not cheap.
    const bool has_pair = std::ranges::any_of(
        pairs_.pairs(), [&](const PairTable::Pair& pair) { return pair.track_id == track.id; });
    const bool is_sure = has_pair && AreSensorsSure(track, frame, map, settings_->vehicle,
                                                    settings_->priority.sensor_support);
    sensed_.push_back({track, is_sure, is_hit});
  }
}

void PriorityPerception::StepVehicle(PriorityVehicle& vehicle, const LocalFrame& frame,
                                     const VisibilityMap& map, Outputs& outputs) {
  const PriorityConfig& config = settings_->priority;
  Link* link = FindLink(vehicle.sender);
  if (link == nullptr) return EndVehicle(vehicle);
  vehicle.PredictTo(frame.stamp, config.filter);

  const Sensed* sensed = FindSensed(vehicle.local_id);
  if (sensed == nullptr) vehicle.local_id = 0;
  if (sensed != nullptr && sensed->is_hit) TakeSensorUpdates(vehicle, *sensed, frame);

  const double unsupported_s = ToSeconds(frame.stamp - vehicle.last_support);
  if (vehicle.is_supported && unsupported_s > config.bridge.support_s) {
    vehicle.is_supported = false;
    vehicle.regained_hits = 0;
    vehicle.regaining_id = 0;
    vehicle.empty = {};
    link->trust.OnSensorsLost();
  }
  if (!vehicle.filter.is_healthy()) {
    outputs.Refuse(Reason::kTrackNumerics, frame.stamp);
    return EndVehicle(vehicle);
  }
  const double silence_s = ToSeconds(frame.stamp - vehicle.last_v2v);
  if (vehicle.is_supported) {
    vehicle.visibility = Visibility::kVisible;
    if (silence_s > config.bridge.max_silence_s) EndVehicle(vehicle);
    return;
  }

  vehicle.visibility = SeenAs(map.Overall(FootprintOfVehicle(vehicle)));
  LookForReturn(vehicle, frame.stamp);
  if (vehicle.is_supported) return link->trust.OnSensorsRegained();
  if (const auto finding = Contradiction(vehicle, frame.stamp)) {
    link->trust.OnFinding(frame.stamp, *finding, MayAccuse());
    return Report(*link, frame.stamp, outputs);
  }
  LookAtPlace(vehicle, frame, map);
  if (vehicle.empty.log_ratio() <= config.bridge.empty_log_ratio) {
    link->trust.OnFinding(frame.stamp,
                          {"empty_place", Verdict::kWithdraw, "log_ratio",
                           vehicle.empty.log_ratio(), config.bridge.empty_log_ratio},
                          MayAccuse());
    return Report(*link, frame.stamp, outputs);
  }
  if (silence_s >= config.bridge.max_gap_s ||
      vehicle.BudgetLeft_s(frame.stamp, config.bridge) <= 0.0 ||
      vehicle.filter.position_sigma_m() >= config.bridge.max_sigma_m) {
    EndVehicle(vehicle);
  }
}

void PriorityPerception::TakeSensorUpdates(PriorityVehicle& vehicle, const Sensed& sensed,
                                           const LocalFrame& frame) {
  const LocalTrack& track = sensed.track;
  vehicle.extent = track.extent;
  const Extent extent = track.ModelExtent();
  bool is_clear = false;
  for (const SensorUpdate& update : frame.updates) {
    if (update.track_id != track.id) continue;
    const StateVector x = vehicle.filter.kinematics().mean;
    std::optional<Linearized> linear;
    if (const auto* radar = std::get_if<RadarMeasurement>(&update.measurement)) {
      linear =
          LinearizeRadar(x, extent, frame.ego,
                         settings_->vehicle.radars[static_cast<std::size_t>(radar->radar)], *radar);
    } else if (const auto* camera = std::get_if<CameraMeasurement>(&update.measurement)) {
      linear = LinearizeCamera(x, extent, frame.ego,
                               settings_->vehicle.cameras[static_cast<std::size_t>(camera->camera)],
                               *camera);
    }
    if (linear) vehicle.filter.Update(*linear);
    is_clear = is_clear || IsInFullView(update.measurement, settings_->priority.bridge);
  }
  vehicle.last_radar = track.last_radar;
  vehicle.last_camera = track.last_camera;
  vehicle.radar_hits = track.radar_hits;
  vehicle.camera_hits = track.camera_hits;
  if (track.object_class != ObjectClass::kUnknown) vehicle.object_class = track.object_class;
  if (!vehicle.is_supported) return;
  vehicle.existence = track.existence;
  vehicle.last_support = frame.stamp;
  vehicle.coast = SensorCoast(track.state_O, frame.stamp);
  if (is_clear) vehicle.clear_coast = vehicle.coast;
  vehicle.empty.OnHit();
  // V2V never moves a vehicle that the sensors see: where the two have come apart, LOCAL is right.
  const Eigen::Vector2d apart = vehicle.filter.mean().head<2>() - track.state_O.mean.head<2>();
  if (apart.norm() > kApart_m + 4.0 * PositionSigma(track.state_O)) {
    vehicle.filter.ResetVehicle(track.state_O);
  }
}

// A vehicle comes back as its own LOCAL track, or as the nearest new one that nobody holds.
void PriorityPerception::LookForReturn(PriorityVehicle& vehicle, Timestamp stamp) {
  const BridgeConfig& config = settings_->priority.bridge;
  const KinematicState here = vehicle.filter.kinematics();
  const Sensed* best = nullptr;
  double best_distance = kReturnGate;
  for (const Sensed& sensed : sensed_) {
    const LocalTrack& track = sensed.track;
    if (!sensed.is_hit) continue;
    const bool is_own = track.id == vehicle.local_id;
    if (!is_own && (IsHeld(track.id) || ToSeconds(vehicle.last_support - track.start) > kSlack_s)) {
      continue;
    }
    const Eigen::Vector2d p_O = track.state_O.mean.head<2>();
    if (!vehicle.CanReach(p_O, stamp, config)) continue;
    const double speed = std::abs(here.mean[kSpeed]) - std::abs(track.state_O.mean[kSpeed]);
    const double speed_sigma = std::sqrt(track.state_O.covariance(kSpeed, kSpeed));
    if (std::abs(speed) > kReturnSpeed_mps + 2.0 * speed_sigma) continue;
    const Eigen::Matrix2d S = here.covariance.topLeftCorner<2, 2>() +
                              track.state_O.covariance.topLeftCorner<2, 2>() +
                              kReturnFloor_m * kReturnFloor_m * Eigen::Matrix2d::Identity();
    const double distance = GateDistance(p_O - here.mean.head<2>(), S);
    if (distance < best_distance) {
      best_distance = distance;
      best = &sensed;
    }
  }
  if (best == nullptr) return;
  const bool continues = vehicle.regaining_id == best->track.id &&
                         ToSeconds(stamp - vehicle.last_regain) <= kPatience_s;
  vehicle.regained_hits = continues ? vehicle.regained_hits + 1 : 1;
  vehicle.regaining_id = best->track.id;
  vehicle.last_regain = stamp;
  vehicle.empty.OnHit();
  if (vehicle.regained_hits < config.regain_hits) return;
  vehicle.local_id = best->track.id;
  vehicle.is_supported = true;
  vehicle.visibility = Visibility::kVisible;
  vehicle.last_support = stamp;
  vehicle.coast = vehicle.clear_coast = SensorCoast(best->track.state_O, stamp);
  vehicle.regaining_id = 0;
  pairs_.SetIncumbent(vehicle.sender, best->track.id);
}

// The real vehicle seen elsewhere: a new track that is where the sensors alone would have expected
// it, moves like it, and is not where the bridge is.
std::optional<Finding> PriorityPerception::Contradiction(const PriorityVehicle& vehicle,
                                                         Timestamp stamp) const {
  const BridgeConfig& config = settings_->priority.bridge;
  if (vehicle.regaining_id != 0 && ToSeconds(stamp - vehicle.last_regain) <= kPatience_s) {
    return std::nullopt;
  }
  const KinematicState& coast = vehicle.coast.state();
  if (PositionSigma(coast) > kUsefulCoast_m) return std::nullopt;
  const KinematicState here = vehicle.filter.kinematics();
  for (const Sensed& sensed : sensed_) {
    const LocalTrack& track = sensed.track;
    if (!sensed.is_hit || track.radar_hits + track.camera_hits < config.regain_hits) continue;
    const bool is_own = track.id == vehicle.local_id;
    if (!is_own && (IsHeld(track.id) || ToSeconds(vehicle.last_support - track.start) > kSlack_s)) {
      continue;
    }
    const StateMatrix& P = track.state_O.covariance;
    const Eigen::Vector2d p_O = track.state_O.mean.head<2>();
    const double apart_m = (p_O - here.mean.head<2>()).norm();
    if (apart_m < config.contradiction_m + 3.0 * vehicle.filter.position_sigma_m()) continue;
    const Eigen::Matrix2d S = coast.covariance.topLeftCorner<2, 2>() + P.topLeftCorner<2, 2>();
    if (GateDistance(p_O - coast.mean.head<2>(), S) > kCoastGate) continue;
    if (std::abs(track.state_O.mean[kSpeed] - coast.mean[kSpeed]) > kSameSpeed_mps) continue;
    if (std::abs(AngleDifference(track.state_O.mean[kYaw], coast.mean[kYaw])) > kSameYaw_rad) {
      continue;
    }
    const bool is_somebody_else = std::ranges::any_of(pairs_.pairs(), [&](const auto& pair) {
      return pair.track_id == track.id && pair.sender != vehicle.sender && pair.is_assigned;
    });
    if (is_somebody_else) continue;
    return Finding{"seen_elsewhere", Verdict::kWithdraw, "distance_m", apart_m,
                   config.contradiction_m};
  }
  return std::nullopt;
}

void PriorityPerception::LookAtPlace(PriorityVehicle& vehicle, const LocalFrame& frame,
                                     const VisibilityMap& map) {
  const Occluder footprint = FootprintOfVehicle(vehicle);
  // Anything seen there, even a track too young to be confirmed, means that it is not empty.
  const double reach_m =
      0.5 * std::hypot(footprint.length_m, footprint.width_m) + 3.0 * footprint.position_sigma_m;
  for (const LocalTrack& track : frame.tracks) {
    if (!IsFresh(track, frame.stamp)) continue;
    if ((track.state_O.mean.head<2>() - footprint.centre_O).norm() < reach_m) return;
  }
  const BridgeConfig& config = settings_->priority.bridge;
  if (const auto probability =
          ClearDetection(footprint, frame, map, settings_->vehicle, config.least_detection)) {
    vehicle.empty.OnMiss(frame.stamp, *probability, config);
  }
}

}  // namespace v2vouch
