// SPDX-License-Identifier: Apache-2.0
// What an own-sensor frame does to the PRIORITY vehicles: support, loss, the end of a bridge.
#include <algorithm>
#include <cmath>
#include <variant>

#include "daemon/base/angle.h"
#include "daemon/models/measurement_model.h"
#include "daemon/pipeline/priority_evidence.h"
#include "daemon/pipeline/priority_perception.h"

namespace v2vouch {
namespace {

// The PRIORITY filter is never allowed this far from a LOCAL track that is being seen.
constexpr double kApart_m = 0.7;
// A bridge is explained by a track, but not from the next lane.
constexpr double kMostSlack_m = 1.0;
constexpr double kMostBias = 0.95;  // Of what a bias may be: the filter stops there.
// A vehicle of which a sensor has had but a part so lately may be misjudged by that part, and its
// track stays in doubt until it has been seen whole for as long.
constexpr double kPart_s = 0.5;
constexpr double kPartPosition_m = 0.5;
constexpr double kPartYaw_rad = FromDegrees(8.0);
constexpr double kExpectedSigma_m = 0.3;
constexpr double kPartSpeed_mps = 0.7;

// What the measurements of a part of a vehicle may be wrong by for as long as it shows no more.
void AddDoubt(StateMatrix& P) {
  P(kX, kX) += kPartPosition_m * kPartPosition_m;
  P(kY, kY) += kPartPosition_m * kPartPosition_m;
  P(kYaw, kYaw) += kPartYaw_rad * kPartYaw_rad;
  P(kSpeed, kSpeed) += kPartSpeed_mps * kPartSpeed_mps;
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

// The look had no more than a part of the vehicle; the rest lay behind something or out of view.
bool IsOfAPart(const SensorMeasurement& measurement, const BridgeConfig& config) {
  if (const auto* radar = std::get_if<RadarMeasurement>(&measurement)) {
    return radar->visible_share < config.part_share;
  }
  const auto& camera = std::get<CameraMeasurement>(measurement);
  return camera.left_is_cut || camera.right_is_cut;
}

// The same of where the vehicle ought to be.
bool IsPartlyCovered(const Occluder& expected, const SensorMeasurement& measurement,
                     const VisibilityMap& map, const BridgeConfig& config) {
  if (const auto* radar = std::get_if<RadarMeasurement>(&measurement)) {
    return map.FromRadar(radar->radar, expected).uncovered < config.part_share;
  }
  const auto& camera = std::get<CameraMeasurement>(measurement);
  const SensorView seen = map.FromCamera(camera.camera, expected);
  return seen.left_is_covered || seen.right_is_covered;
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

// Where the sender of a supported vehicle has it, by the residual that its claims had ten seconds
// ago; of the size that the sensors give it. A LOCAL track that a part of its vehicle drags along
// lies in clear view all the time, since its own footprint goes with the part. The claims tell that
// the rest is hidden.
std::optional<Occluder> PriorityPerception::ExpectedFootprint(const LocalTrack& track,
                                                              Timestamp stamp) const {
  const auto vehicle = std::ranges::find_if(vehicles_, [&](const PriorityVehicle& candidate) {
    return candidate.id != 0 && candidate.is_supported && candidate.local_id == track.id;
  });
  if (vehicle == vehicles_.end()) return std::nullopt;
  const Link* link = FindLink(vehicle->sender);
  if (link == nullptr || !IsRecent(*link, stamp)) return std::nullopt;
  const ResidualHistory& history = link->trust.history();
  if (!history.is_settled()) return std::nullopt;
  const bool has_direction = link->last.has_course;
  return Occluder{
      .id = track.id,
      .centre_O = link->last.PlaceAt(stamp) - history.reference_O().value_or(history.mean_O()),
      .yaw_rad = has_direction ? link->last.yaw_rad : track.state_O.mean[kYaw],
      .length_m = track.extent.length_m,
      .width_m = track.extent.width_m,
      .position_sigma_m = kExpectedSigma_m};
}

void PriorityPerception::Remember(const LocalFrame& frame, const VisibilityMap& map) {
  sensed_stamp_ = frame.stamp;
  parts_.clear();
  for (const Sensed& sensed : sensed_) {
    if (sensed.parts) parts_.push_back(*sensed.parts);
  }
  sensed_.clear();
  for (const LocalTrack& track : frame.tracks) {
    if (!track.is_confirmed) continue;
    const bool is_hit =
        IsFresh(track, frame.stamp) ||
        std::ranges::find(frame.updates, track.id, &SensorUpdate::track_id) != frame.updates.end();
    // Coverage is asked for tracks that a sender may be; the question is not cheap.
    const auto is_of_track = [&](const PairTable::Pair& pair) { return pair.track_id == track.id; };
    const bool has_pair = std::ranges::any_of(pairs_.pairs(), is_of_track) ||
                          std::ranges::any_of(pairs_apart_.pairs(), is_of_track);
    const bool is_sure = has_pair && AreSensorsSure(track, frame, map, settings_->vehicle,
                                                    settings_->priority.sensor_support);
    Sensed& sensed =
        sensed_.emplace_back(Sensed{.track = track, .is_sure = is_sure, .is_hit = is_hit});
    const auto before = std::ranges::find(parts_, track.id, &PartialLooks::track_id);
    if (before != parts_.end()) sensed.parts = *before;
    const std::optional<Occluder> expected = ExpectedFootprint(track, frame.stamp);
    const bool is_of_a_part = std::ranges::any_of(frame.updates, [&](const SensorUpdate& update) {
      return update.track_id == track.id &&
             (IsOfAPart(update.measurement, settings_->priority.bridge) ||
              (expected &&
               IsPartlyCovered(*expected, update.measurement, map, settings_->priority.bridge)));
    });
    if (is_of_a_part) {
      sensed.parts = PartialLooks{track.id, frame.stamp, std::nullopt};
    } else if (is_hit && sensed.parts && !sensed.parts->whole) {
      sensed.parts->whole = frame.stamp;
    }
    if (sensed.parts) {
      const auto& [id, last, whole] = *sensed.parts;
      sensed.is_partial = ToSeconds(frame.stamp - last) <= kPart_s;
      // A track that coasts goes on as the part had it, however long.
      sensed.is_doubtful = !whole || ToSeconds(track.LastHit() - *whole) < kPart_s;
    }
    if (sensed.is_partial) AddDoubt(sensed.track.state_O.covariance);
  }
}

void PriorityPerception::StepVehicle(PriorityVehicle& vehicle, const LocalFrame& frame,
                                     const VisibilityMap& map, Outputs& outputs) {
  const PriorityConfig& config = settings_->priority;
  Link* link = FindLink(vehicle.sender);
  if (link == nullptr) return EndVehicle(vehicle, frame.stamp);
  vehicle.PredictTo(frame.stamp, config.filter);

  const Sensed* sensed = FindSensed(vehicle.local_id);
  if (sensed == nullptr) vehicle.local_id = 0;
  // The LOCAL track of a hidden vehicle may have gone over to what hides it.
  if (sensed != nullptr && sensed->is_hit &&
      (vehicle.is_supported ||
       (!sensed->is_partial && IsWhereClaimed(sensed->track, vehicle, frame.stamp)))) {
    TakeSensorUpdates(vehicle, *sensed, frame);
  }

  const double unsupported_s = ToSeconds(frame.stamp - vehicle.last_support);
  if (vehicle.is_supported && unsupported_s > config.bridge.support_s) {
    // Sensors and sender had come apart by more than any bias: there is nothing to carry on.
    if (vehicle.filter.bias().norm() > kMostBias * config.filter.max_bias_m) {
      return EndVehicle(vehicle, frame.stamp);
    }
    vehicle.is_supported = false;
    vehicle.regained_hits = 0;
    vehicle.regaining_id = 0;
    vehicle.elsewhere_id = 0;
    vehicle.velocity_doubts = 0;
    vehicle.empty = {};
    link->trust.OnSensorsLost();
  }
  if (!vehicle.filter.is_healthy()) {
    outputs.Refuse(Reason::kTrackNumerics, frame.stamp);
    return EndVehicle(vehicle, frame.stamp);
  }
  const double silence_s = ToSeconds(frame.stamp - vehicle.last_v2v);
  if (vehicle.is_supported) {
    vehicle.visibility = Visibility::kVisible;
    if (silence_s > config.bridge.max_silence_s) EndVehicle(vehicle, frame.stamp);
    return;
  }

  vehicle.visibility = SeenAs(map.Overall(FootprintOfVehicle(vehicle)));
  LookForReturn(vehicle, frame.stamp);
  if (vehicle.is_supported) return link->trust.OnSensorsRegained();
  if (const auto finding = Contradiction(vehicle, frame.stamp)) {
    const Sensed* elsewhere = FindSensed(vehicle.elsewhere_id);
    if (elsewhere != nullptr && elsewhere->is_doubtful) return EndVehicle(vehicle, frame.stamp);
    link->trust.OnFinding(frame.stamp, *finding, MayAccuse(frame.stamp));
    return Report(*link, frame.stamp, outputs);
  }
  LookAtPlace(vehicle, frame, map);
  // Where we carried the vehicle there is none. That may be our own error: what the sender claims
  // is looked at beside (LookAtClaims), and blamed where it is empty, too.
  if (vehicle.empty.log_ratio() <= config.bridge.empty_log_ratio ||
      silence_s >= config.bridge.max_gap_s ||
      vehicle.BudgetLeft_s(frame.stamp, config.bridge) <= 0.0 ||
      vehicle.filter.position_sigma_m() >= config.bridge.max_sigma_m ||
      (vehicle.filter.mean().head<2>() - frame.ego.X_OB.origin().vector()).norm() >=
          config.bridge.max_distance_m ||
      // The sensors see another vehicle of the list there: both are one, or this one went astray.
      HasAnotherAt(vehicle.filter.mean().head<2>(), vehicle.sender, true)) {
    EndVehicle(vehicle, frame.stamp);
  }
}

void PriorityPerception::TakeSensorUpdates(PriorityVehicle& vehicle, const Sensed& sensed,
                                           const LocalFrame& frame) {
  const LocalTrack& track = sensed.track;
  vehicle.extent = track.extent;
  const Extent extent = track.ModelExtent();
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
  }
  vehicle.last_radar = track.last_radar;
  vehicle.last_camera = track.last_camera;
  vehicle.radar_hits = track.radar_hits;
  vehicle.camera_hits = track.camera_hits;
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
  // with the size, and no claim tells it apart from the sender's bias. While but a part is seen the
  // filter keeps to what it knew of the whole, or the part would drag it along; the doubt is still
  // published.
  const Eigen::Matrix2d P = track.state_O.covariance.topLeftCorner<2, 2>();
  if (!sensed.is_partial) vehicle.filter.WidenPosition(P);
  vehicle.lasting = vehicle.filter.LackOf(P);
  vehicle.agreed = Coast(vehicle.filter.kinematics(), frame.stamp);
}

void PriorityPerception::LookAtPlace(PriorityVehicle& vehicle, const LocalFrame& frame,
                                     const VisibilityMap& map) {
  const Occluder footprint = FootprintOfVehicle(vehicle);
  // Anything seen there, even a track too young to be confirmed, means that it is not empty; but
  // not a vehicle in the next lane, nor one that is somebody else's.
  const double slack_m = std::min(2.0 * footprint.position_sigma_m, kMostSlack_m);
  for (const LocalTrack& track : frame.tracks) {
    if (!IsFresh(track, frame.stamp) || !AreClose(footprint, track, slack_m)) continue;
    if (!IsHeldByAnother(track.id, vehicle.sender) && !IsAnothers(track.id, vehicle.sender)) return;
  }
  const BridgeConfig& config = settings_->priority.bridge;
  if (const auto probability = ClearDetection(footprint, frame, map, settings_->vehicle,
                                              ClearTo::kAnySensor, config.least_detection)) {
    vehicle.empty.OnMiss(frame.stamp, *probability, config);
  } else {
    vehicle.empty.OnCovered();
  }
}

}  // namespace v2vouch
