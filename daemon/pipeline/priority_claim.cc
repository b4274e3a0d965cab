// SPDX-License-Identifier: Apache-2.0
// What a claim does: evidence for pairs, trust, validation, and the fused filters.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "daemon/base/angle.h"
#include "daemon/models/ctra.h"
#include "daemon/pipeline/priority_evidence.h"
#include "daemon/pipeline/priority_perception.h"

namespace v2vouch {
namespace {

constexpr double kMaxFrameAge_s = 0.5;  // Older tracks are not compared with anything.
constexpr double kPairReach_m = 20.0;   // No claim, however poor, starts a pair from farther away.
constexpr double kUnknownAccel_mps2 = 4.0;
constexpr double kOwnMotionFloor_m = 2.0;
constexpr double kMostAccel_mps2 = 12.0;
constexpr double kSpeedFloor_mps = 2.0;
constexpr int kBreakMemory = 30;  // Messages for which a break of the own motion is held against.
constexpr int kMostVelocityDoubts = 2;
constexpr double kSeldom_s = 0.5;
constexpr double kLongestLost_s = 10.0;  // A sender that does not know its place says nothing then.

// Findings that a second device under the same id brings, whoever of the two lies.
bool IsOfAJump(std::string_view check) {
  return check == "position_jump" || check == "two_places" || check == "own_motion";
}

}  // namespace

std::optional<KinematicState> PriorityPerception::SensedAt(std::uint64_t local_id,
                                                           Timestamp stamp) const {
  const Sensed* sensed = FindSensed(local_id);
  const double dt_s = ToSeconds(stamp - sensed_stamp_);
  if (sensed == nullptr || dt_s > kMaxFrameAge_s) return std::nullopt;
  KinematicState state = sensed->track.state_O;
  if (dt_s > 0.0) PredictCtra(state, dt_s, settings_->priority.filter.motion);
  return state;
}

// Whether the message continues the last one: the place where the last would have the sender now.
// Jumps in the message stream do not count where the sensors see the vehicle just where this claim
// has it: somebody else may speak under the id. What a sender says of its motion does.
void PriorityPerception::JudgeMessages(Link& link, const PriorityVehicle* vehicle,
                                       const Claim& claim, const ClaimInOdometry& here) {
  const TrustConfig& config = settings_->priority.trust;
  bool is_consistent = true;
  if (link.has_last && !claim.accuracy_is_poor) {
    const ClaimInOdometry& last = link.last;
    const double dt_s = std::max(0.0, ToSeconds(here.stamp - last.stamp));
    const double speed_mps = 0.5 * (last.speed_mps + here.speed_mps);
    const double yaw_rad = last.yaw_rad + 0.5 * AngleDifference(here.yaw_rad, last.yaw_rad);
    const Eigen::Vector2d expected =
        last.p_O + speed_mps * dt_s * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
    const double sigma_m = std::sqrt(0.5 * (last.noise.trace() + here.noise.trace()));
    is_consistent =
        (here.p_O - expected).norm() <=
            kOwnMotionFloor_m + 3.0 * sigma_m + 0.5 * kUnknownAccel_mps2 * dt_s * dt_s &&
        std::abs(here.speed_mps - last.speed_mps) <= kSpeedFloor_mps + kMostAccel_mps2 * dt_s;
  }
  link.breaks = is_consistent ? std::max(0, link.breaks - 1) : kBreakMemory;
  link.trust.OnMessage(here.stamp, is_consistent, config);
  if (!claim.finding) return;
  const bool is_seen = vehicle != nullptr && vehicle->is_supported && link.trust.is_relied_on();
  if (is_seen && link.odd_claims == 0 && IsOfAJump(claim.finding->check)) return;
  link.trust.OnFinding(here.stamp, *claim.finding, MayAccuse(here.stamp));
}

void PriorityPerception::ObservePairs(Link& link, const ClaimInOdometry& here) {
  const PriorityConfig& config = settings_->priority;
  const double dt_s = ToSeconds(here.stamp - sensed_stamp_);
  if (sensed_.empty() || dt_s > kMaxFrameAge_s) return;
  // Who seems to be on another level is observed apart: it takes no track and rivals nobody, but
  // should the difference turn out to be common to all, the observations count.
  const bool is_apart = IsOnAnotherLevel(link);
  PairTable& pairs = is_apart ? pairs_apart_ : pairs_;
  if (!is_apart) pairs_.TakeFrom(pairs_apart_, link.sender, config.safe);
  const auto prior = PriorOf(link);
  bool has_changed = false;
  for (const Sensed& sensed : sensed_) {
    const double distance_m = (sensed.track.state_O.mean.head<2>() - here.p_O).norm();
    const bool is_known = pairs.Find(link.sender, sensed.track.id) != nullptr;
    if (distance_m > kPairReach_m && !is_known) continue;
    KinematicState state = sensed.track.state_O;
    if (dt_s > 0.0) PredictCtra(state, dt_s, config.filter.motion);
    has_changed |= pairs.Observe(link.sender, sensed.track.id, Compare(here, state), prior,
                                 config.safe) != nullptr;
  }
  if (has_changed) pairs.Assign(config.safe);
}

// Raw residuals against the LOCAL track the sender is taken for. Hidden vehicles have none.
void PriorityPerception::CompareWithSensors(Link& link, PriorityVehicle* vehicle,
                                            const ClaimInOdometry& here) {
  const PriorityConfig& config = settings_->priority;
  std::uint64_t local_id = 0;
  if (vehicle != nullptr) {
    local_id = vehicle->is_supported ? vehicle->local_id : 0;
  } else if (link.trust.has_penalty() && FindSensed(link.withdrawn_id) != nullptr) {
    local_id = link.withdrawn_id;
  } else if (const PairTable::Pair* pair = pairs_.AssignedTo(link.sender)) {
    // A long agreement in velocity alone can carry any offset: such a track is another's.
    if (pair->evidence.level() <= config.safe.max_level) local_id = pair->track_id;
  }
  const auto state = SensedAt(local_id, here.stamp);
  if (!state) return;
  // Beside another track nothing goes on of what was held against it beside the last one.
  if (vehicle == nullptr && link.compared_id != local_id) link.trust.ForgetResiduals();
  link.compared_id = local_id;
  CoObservation observation = ForTrust(here, *state);
  const Sensed* sensed = FindSensed(local_id);
  if (sensed != nullptr) observation.extent_sigma_m = 0.5 * sensed->track.extent.length_sigma_m;
  observation.is_partial = sensed != nullptr && sensed->is_partial && link.trust.is_relied_on();
  observation.is_doubtful = sensed != nullptr && sensed->is_doubtful;
  observation.is_plausible = IsVouchedFor(link);
  observation.is_own_motion_whole = link.breaks == 0;
  observation.is_ego_shifted = IsShifted(here.stamp);
  observation.shift_O = common_.shift_O();
  // A LOCAL track that goes over to another car leaves an honest sender just as a liar leaves its
  // car. The liar's place is empty.
  const bool may_accuse = MayAccuse(here.stamp) && common_.HasWitnessAgainst(link.sender) &&
                          link.place.log_ratio() <= config.trust.place.lasting_log_ratio;
  if (!link.trust.OnCoObservation(observation, may_accuse, config.trust)) {
    pairs_.DropSender(link.sender);
    link.withdrawn_id = 0;
    if (vehicle != nullptr) EndVehicle(*vehicle, here.stamp);
    return;
  }
  if (vehicle == nullptr || !link.trust.is_relied_on() || alignment_.is_suspect()) return;
  const Eigen::Matrix2d R_LO = alignment_.X_LO().rotation();
  const Eigen::Matrix2d P = state->covariance.topLeftCorner<2, 2>() + here.noise + here.alignment;
  residuals_.push_back(
      {link.sender, here.stamp, R_LO * observation.residual_O, R_LO * P * R_LO.transpose()});
  alignment_.Vouch(here.stamp);
}

void PriorityPerception::UseClaim(Link& link, PriorityVehicle& vehicle,
                                  const ClaimInOdometry& here) {
  const PriorityConfig& config = settings_->priority;
  if (!link.trust.is_relied_on()) return;
  const double since_last_s = ToSeconds(here.stamp - vehicle.last_v2v);
  vehicle.PredictTo(here.stamp, config.filter);
  const ClaimFit fit = vehicle.filter.Update(here, config.filter);
  vehicle.last_v2v = here.stamp;
  if (vehicle.is_supported) {
    vehicle.misfits_in_a_row = 0;  // Sensors judge it by its raw residual.
    if (fit.is_used)
      vehicle.co_observed_s += std::clamp(since_last_s, 0.0, config.bridge.max_gap_s);
    return;
  }
  CountMisfits(vehicle, fit.is_used && fit.is_velocity_used, fit.is_used, since_last_s, here.stamp);
  if (vehicle.id == 0) return;
  if (vehicle.misfits_in_a_row < config.bridge.max_misfits) {
    return KeepWithinReach(link, vehicle, here.stamp);
  }
  // While a sender's messages continue each other, what does not fit may be what we carried: the
  // last look had but a part of the vehicle, or the vehicle has turned. Then the bridge just ends.
  if (link.breaks == 0) return EndVehicle(vehicle, here.stamp);
  link.trust.OnFinding(here.stamp,
                       {"bridge_misfit", Verdict::kWithdraw, "position_nis", fit.position_nis,
                        config.filter.position_gate},
                       MayAccuse(here.stamp));
}

// The sensors alone place the vehicle meanwhile, and while it is hidden it goes on as it says.
void PriorityPerception::UseMotion(Link& link, PriorityVehicle& vehicle,
                                   const ClaimInOdometry& here) {
  const PriorityConfig& config = settings_->priority;
  if (!link.trust.is_relied_on()) return;
  if (ToSeconds(here.stamp - link.last.stamp) > kLongestLost_s) {
    return EndVehicle(vehicle, here.stamp);
  }
  vehicle.PredictTo(here.stamp, config.filter);
  const double since_last_s = ToSeconds(here.stamp - vehicle.last_v2v);
  const bool is_used = vehicle.filter.UpdateMotion(here, config.filter);
  vehicle.last_v2v = here.stamp;
  if (vehicle.is_supported) return;
  CountMisfits(vehicle, is_used, true, since_last_s, here.stamp);
  if (vehicle.id != 0) KeepWithinReach(link, vehicle, here.stamp);
}

// Where the place fits and the motion does not, the motion was last measured by a part of the
// vehicle, or the vehicle has braked or turned. Where it can be is bounded all the same. Who speaks
// seldom is carried far in a false direction meanwhile: there one message is enough.
void PriorityPerception::CountMisfits(PriorityVehicle& vehicle, bool fits, bool place_fits,
                                      double since_last_s, Timestamp stamp) {
  const int most = settings_->priority.bridge.max_misfits;
  const int more = since_last_s > kSeldom_s ? most : 1;
  vehicle.misfits_in_a_row = fits ? 0 : vehicle.misfits_in_a_row + more;
  if (vehicle.misfits_in_a_row < most || !place_fits) return;
  vehicle.filter.DoubtVelocity();
  vehicle.misfits_in_a_row = 0;
  if (++vehicle.velocity_doubts > kMostVelocityDoubts) EndVehicle(vehicle, stamp);
}

void PriorityPerception::KeepWithinReach(Link& link, PriorityVehicle& vehicle, Timestamp stamp) {
  const Eigen::Vector2d p_O = vehicle.filter.mean().head<2>();
  if (vehicle.CanReach(p_O, stamp, settings_->priority.bridge)) return;
  // The sensors see a vehicle there that is where its sender says.
  if (IsReturning(vehicle, stamp)) return;
  if (link.breaks == 0) return EndVehicle(vehicle, stamp);
  link.trust.OnFinding(stamp,
                       {"out_of_reach", Verdict::kWithdraw, "distance_m",
                        (p_O - vehicle.coast.state().mean.head<2>()).norm(), 0.0},
                       MayAccuse(stamp));
}

void PriorityPerception::TryValidate(Link& link, const ClaimInOdometry& here) {
  const PriorityConfig& config = settings_->priority;
  const PairTable::Pair* pair = pairs_.AssignedTo(link.sender);
  if (pair == nullptr || IsHeld(pair->track_id) || link.shared.is_contested()) return;
  const Sensed* sensed = FindSensed(pair->track_id);
  if (sensed == nullptr) return;
  // A new track where a hidden vehicle is carried is sooner that vehicle come back.
  if (HasAnotherAt(sensed->track.state_O.mean.head<2>(), link.sender, false)) return;
  const Timestamp last_hit = sensed->track.LastHit();
  const bool is_seen = ToSeconds(here.stamp - last_hit) <= config.bridge.support_s;
  const PairEvidence& evidence = pair->evidence;
  if (!link.trust.TryValidate(
          {.stamp = here.stamp,
           .co_observations = evidence.observations(),
           .span_s = evidence.span_s(),
           .is_nis_consistent = evidence.is_nis_consistent(),
           .is_speed_consistent = evidence.is_speed_consistent(config.safe),
           .is_level_plausible = evidence.level() <= config.safe.max_level,
           .is_size_plausible =
               IsSizePlausible(link.length_m, link.width_m, sensed->track.extent, config.trust),
           .margin = std::min(pairs_.Margin(*pair), MarginOverUnseen(link, *pair)),
           .min_margin = config.safe.min_margin,
           .is_assigned = pair->is_assigned,
           .are_sensors_sure = sensed->is_sure && is_seen,
           .is_ego_gnss_suspect = alignment_.is_suspect()},
          config.trust)) {
    return;
  }
  std::uint64_t id = PriorityId(sensed->track.id, 0);
  for (int attempt = 1; std::ranges::find(vehicles_, id, &PriorityVehicle::id) != vehicles_.end();
       ++attempt) {
    id = PriorityId(sensed->track.id, attempt);
  }
  const LocalTrack& track = sensed->track;
  PriorityVehicle vehicle{
      .id = id,
      .local_id = track.id,
      .sender = link.sender,
      .start = here.stamp,
      .filter =
          PriorityFilter(track.state_O, sensed_stamp_, evidence.bias(), evidence.bias_covariance(),
                         std::sqrt(alignment_.covariance()(2, 2)), config.filter),
      .coast = Coast(track.state_O, sensed_stamp_),
      .agreed = Coast(track.state_O, sensed_stamp_),
      .last_support = last_hit,
      .co_observed_s = evidence.span_s(),
      .last_v2v = here.stamp,
      .extent = track.extent,
      .object_class = track.object_class,
      .existence = track.existence,
      .last_radar = track.last_radar,
      .last_camera = track.last_camera,
      .radar_hits = track.radar_hits,
      .camera_hits = track.camera_hits};
  vehicle.PredictTo(here.stamp, config.filter);
  pairs_.SetIncumbent(link.sender, track.id);
  vehicles_.insert(std::ranges::lower_bound(vehicles_, id, {}, &PriorityVehicle::id), vehicle);
}

}  // namespace v2vouch
