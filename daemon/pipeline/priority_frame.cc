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
// How far a vehicle that comes back may be from where its sender says, bias taken off: less across
// than along, where lanes lie and where the sender's own age of position does not reach. Beside it
// twice the doubt, but a track that is not known better than this is not taken for anybody.
constexpr double kClaimedAlong_m = 2.5;
constexpr double kClaimedAcross_m = 1.2;
constexpr double kClaimedSpeed_mps = 2.5;
constexpr double kMostDoubt_m = 1.5;
constexpr double kMostDoubt_mps = 1.5;
constexpr double kSlack_s = 0.5;     // A track born so long before the loss may still be its heir.
constexpr double kPatience_s = 0.5;  // Hits of a return may lie so far apart.
// A coast less certain than this contradicts nobody.
constexpr double kUsefulCoast_m = 4.0;
constexpr double kCoastGate = 9.21;
constexpr double kSameSpeed_mps = 3.0;
constexpr double kSameYaw_rad = FromDegrees(30.0);
// The PRIORITY filter is never allowed this far from a LOCAL track that is being seen.
constexpr double kApart_m = 0.7;
// A vehicle of which a sensor has had but a part so lately may be misjudged by that part.
constexpr double kPart_s = 0.5;
constexpr double kPartPosition_m = 0.5;
constexpr double kPartYaw_rad = FromDegrees(8.0);
constexpr double kPartSpeed_mps = 0.7;

double GateDistance(const Eigen::Vector2d& d, const Eigen::Matrix2d& S) {
  return d.dot(S.inverse() * d);
}

// What the measurements of a part of a vehicle may be wrong by for as long as it shows no more.
void AddDoubt(StateMatrix& P) {
  P(kX, kX) += kPartPosition_m * kPartPosition_m;
  P(kY, kY) += kPartPosition_m * kPartPosition_m;
  P(kYaw, kYaw) += kPartYaw_rad * kPartYaw_rad;
  P(kSpeed, kSpeed) += kPartSpeed_mps * kPartSpeed_mps;
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

// The look had no more than a part of the vehicle; the rest lay behind something or out of view.
bool IsOfAPart(const SensorMeasurement& measurement, const BridgeConfig& config) {
  if (const auto* radar = std::get_if<RadarMeasurement>(&measurement)) {
    return radar->visible_share < config.part_share;
  }
  const auto& camera = std::get<CameraMeasurement>(measurement);
  return camera.left_is_cut || camera.right_is_cut;
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
  parts_.clear();
  for (const Sensed& sensed : sensed_) {
    if (sensed.last_part) parts_.emplace_back(sensed.track.id, *sensed.last_part);
  }
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
    Sensed& sensed = sensed_.emplace_back(Sensed{track, is_sure, is_hit, {}, false});
    for (const auto& [id, last_part] : parts_) {
      if (id == track.id) sensed.last_part = last_part;
    }
    for (const SensorUpdate& update : frame.updates) {
      if (update.track_id != track.id) continue;
      if (IsOfAPart(update.measurement, settings_->priority.bridge)) {
        sensed.last_part = frame.stamp;
      }
    }
    sensed.is_partial = sensed.last_part && ToSeconds(frame.stamp - *sensed.last_part) <= kPart_s;
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
      IsOnSupported(vehicle)) {
    EndVehicle(vehicle, frame.stamp);
  }
}

// The sensors see another vehicle of the list where this one is carried: both are one, or the
// bridge has gone astray.
bool PriorityPerception::IsOnSupported(const PriorityVehicle& bridged) const {
  return std::ranges::any_of(vehicles_, [&](const PriorityVehicle& other) {
    return other.id != 0 && other.is_supported &&
           (other.filter.mean() - bridged.filter.mean()).head<2>().norm() <= kOnePlace_m;
  });
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

// Its sender has gone on speaking: what comes back must be where it says, its known bias taken off,
// and move as it says. Another car that comes into view near by is not it.
bool PriorityPerception::IsWhereClaimed(const LocalTrack& track, const PriorityVehicle& vehicle,
                                        Timestamp stamp) const {
  const Link* link = FindLink(vehicle.sender);
  if (link == nullptr || !link->has_last) return true;
  const ClaimInOdometry& claim = link->last;
  const double age_s = ToSeconds(stamp - claim.stamp);
  if (std::abs(age_s) > kPatience_s) return true;
  const Eigen::Vector2d off_O =
      claim.p_O + age_s * claim.velocity_O() - vehicle.filter.bias() - track.state_O.mean.head<2>();
  const double yaw_rad = claim.has_course ? claim.yaw_rad : track.state_O.mean[kYaw];
  const Eigen::Vector2d ahead(std::cos(yaw_rad), std::sin(yaw_rad));
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  const Eigen::Matrix2d P = claim.noise + track.state_O.covariance.topLeftCorner<2, 2>();
  const double along_sigma_m = std::sqrt(ahead.dot(P * ahead));
  const double across_sigma_m = std::sqrt(left.dot(P * left));
  if (std::max(along_sigma_m, across_sigma_m) > kMostDoubt_m) return false;
  if (std::abs(ahead.dot(off_O)) > kClaimedAlong_m + 2.0 * along_sigma_m) return false;
  if (std::abs(left.dot(off_O)) > kClaimedAcross_m + 2.0 * across_sigma_m) return false;
  if (!claim.has_course) return true;
  const double yaw_mps = std::sqrt(track.state_O.covariance(kYaw, kYaw)) * claim.speed_mps;
  const double speed_sigma_mps = std::sqrt(track.state_O.covariance(kSpeed, kSpeed));
  return (claim.velocity_O() - track.state_O.velocity()).norm() <=
         kClaimedSpeed_mps + 2.0 * std::min(std::hypot(speed_sigma_mps, yaw_mps), kMostDoubt_mps);
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
    if (!IsWhereClaimed(track, vehicle, stamp)) continue;
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
  vehicle.coast = Coast(best->track.state_O, stamp);
  vehicle.agreed = Coast(vehicle.filter.kinematics(), stamp);
  vehicle.regaining_id = 0;
  pairs_.SetIncumbent(vehicle.sender, best->track.id);
}

// The real vehicle seen elsewhere: a new track that is where the sensors alone would have expected
// it, moves like it, and is not where the bridge is.
std::optional<Finding> PriorityPerception::Contradiction(PriorityVehicle& vehicle,
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
    // One hit may be anything, on a track that coasts above all.
    const bool continues = vehicle.elsewhere_id == track.id &&
                           ToSeconds(stamp - vehicle.last_elsewhere) <= kPatience_s;
    vehicle.elsewhere_hits = continues ? vehicle.elsewhere_hits + 1 : 1;
    vehicle.elsewhere_id = track.id;
    vehicle.last_elsewhere = stamp;
    if (vehicle.elsewhere_hits < config.regain_hits) return std::nullopt;
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
  } else {
    vehicle.empty.OnCovered();
  }
}

}  // namespace v2vouch
