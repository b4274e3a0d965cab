// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/claim_judgement.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/kinematic_limits.h"
#include "daemon/common/data/motion_continuity.h"
#include "daemon/v2v/perception/claimed_position.h"
#include "daemon/v2v/perception/claimed_size.h"
#include "daemon/v2v/perception/evidence.h"

namespace v2vouch {
namespace {

constexpr int kBreakMemory = 30;  // Messages for which a break of the own motion is held against.

// Findings that a second device under the same id causes, whichever of the two lies.
bool IsOfAJump(Check check) {
  return check == Check::kPositionJump || check == Check::kTwoPlaces || check == Check::kOwnMotion;
}

// The LOCAL track that a claim's residual is taken against; 0: none.
std::uint64_t TrackToCompareWith(const V2vView& view, const SenderRecord& record,
                                 const PriorityVehicle* vehicle) {
  if (vehicle != nullptr) return vehicle->is_supported ? vehicle->local_id : 0;
  if (record.trust.has_penalty() && view.tracks.Find(record.withdrawn_id) != nullptr) {
    return record.withdrawn_id;
  }
  // A long agreement in velocity alone can carry any offset: such a track is another vehicle's.
  const PairTable::Pair* pair = view.pairs.AssignedTo(record.sender);
  const bool may_be_it = pair != nullptr && pair->evidence.level() <= view.config.safe.max_level;
  return may_be_it ? pair->track_id : 0;
}

// The LOCAL track at `at`, with the size that the sender tells.
std::optional<LocalTrack> SensedAt(const V2vView& view, const SenderRecord& record,
                                   std::uint64_t local_id, Timestamp at) {
  const TrackSnapshot* seen = view.tracks.Find(local_id);
  const double dt_s = ToSeconds(at - view.tracks.stamp());
  if (seen == nullptr || dt_s > TrackSnapshots::kMaxAge_s) return std::nullopt;
  LocalTrack track = GivenClaimedSize(seen->track, &record, view.config.trust);
  if (dt_s > 0.0) PredictCtra(track.state_O, dt_s, view.config.filter.motion);
  return track;
}

}  // namespace

bool IsFromAnotherDevice(const V2vView& view, SenderRecord& record, const PriorityVehicle* vehicle,
                         const ClaimInOdometry& here) {
  const TrustConfig& config = view.config.trust;
  if (vehicle == nullptr || !vehicle->is_supported || !record.trust.is_relied_on()) return false;
  const ResidualHistory& history = record.trust.history();
  const auto sensed = SensedAt(view, record, vehicle->local_id, here.stamp);
  if (!sensed || !history.is_settled()) return false;
  const Eigen::Vector2d off_O = here.p_O - sensed->state_O.mean.head<2>() - history.mean_O();
  const double limit_m = config.odd_claim_m + 2.0 * std::sqrt(0.5 * here.noise.trace()) +
                         config.stale_position_s * std::abs(sensed->state_O.mean[kSpeed]);
  if (off_O.norm() <= limit_m) {
    record.odd_claims = 0;
    return false;
  }
  return ++record.odd_claims < config.odd_claims;
}

bool ContinuesLastClaim(const SenderRecord& record, const Claim& claim,
                        const ClaimInOdometry& here) {
  if (!record.has_last || claim.accuracy_is_poor) return true;
  const ClaimInOdometry& last = record.last;
  const double dt_s = std::max(0.0, ToSeconds(here.stamp - last.stamp));
  const double speed_mps = 0.5 * (last.speed_mps + here.speed_mps);
  const double yaw_rad = last.yaw_rad + 0.5 * AngleDifference(here.yaw_rad, last.yaw_rad);
  const Eigen::Vector2d expected =
      last.p_O + speed_mps * dt_s * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
  const double sigma_m = std::sqrt(0.5 * (last.noise.trace() + here.noise.trace()));
  return (here.p_O - expected).norm() <=
             kContinues_m + 3.0 * sigma_m + 0.5 * kUnannounced_mps2 * dt_s * dt_s &&
         std::abs(here.speed_mps - last.speed_mps) <= kContinues_mps + kMostRoadAccel_mps2 * dt_s;
}

void JudgeMessage(SenderRecord& record, const PriorityVehicle* vehicle, const Claim& claim,
                  const ClaimInOdometry& here, bool may_accuse, const TrustConfig& config) {
  const bool is_consistent = ContinuesLastClaim(record, claim, here);
  record.breaks = is_consistent ? std::max(0, record.breaks - 1) : kBreakMemory;
  record.trust.OnMessage(here.stamp, is_consistent, config);
  if (!claim.finding) return;
  const bool is_seen = vehicle != nullptr && vehicle->is_supported && record.trust.is_relied_on();
  if (is_seen && record.odd_claims == 0 && IsOfAJump(claim.finding->check)) return;
  record.trust.OnFinding(here.stamp, *claim.finding, may_accuse);
}

Comparison CompareWithSensors(const V2vView& view, SenderRecord& record,
                              const PriorityVehicle* vehicle, const ClaimInOdometry& here,
                              const CommonMode& common, const EgoDoubt& doubt) {
  const TrustConfig& config = view.config.trust;
  Comparison comparison;
  const std::uint64_t local_id = TrackToCompareWith(view, record, vehicle);
  const auto sensed = SensedAt(view, record, local_id, here.stamp);
  if (!sensed) return comparison;
  comparison.is_made = true;
  // Residual history restarts when the associated track changes.
  if (vehicle == nullptr && record.compared_id != local_id) record.trust.ForgetResiduals();
  record.compared_id = local_id;
  const TrackSnapshot& seen = *view.tracks.Find(local_id);
  CoObservation observation = ForTrust(here, sensed->state_O);
  observation.extent_sigma_m = 0.5 * sensed->extent.length_sigma_m;
  observation.is_partial = seen.is_partial && record.trust.is_relied_on();
  observation.is_doubtful = seen.is_doubtful;
  observation.is_plausible = IsSeenBySensors(view, record);
  observation.is_own_motion_whole = record.breaks == 0;
  observation.is_ego_shifted = doubt.is_shifted;
  observation.shift_O = common.shift_O();
  // A LOCAL track that switches to another car leaves an honest sender just as a liar leaves its
  // car. The liar's position is empty.
  const bool may_accuse = doubt.may_accuse() && common.HasWitnessAgainst(record.sender) &&
                          record.place.log_ratio() <= config.place.lasting_log_ratio;
  comparison.is_track_switch = !record.trust.OnCoObservation(observation, may_accuse, config);
  comparison.residual_O = observation.residual_O;
  comparison.covariance_O =
      sensed->state_O.covariance.topLeftCorner<2, 2>() + here.noise + here.alignment;
  return comparison;
}

bool AgreesButForHeight(const V2vView& view, const PairTable::Pair& pair, Timestamp now) {
  const TrackSnapshot* seen = view.tracks.Find(pair.track_id);
  const PairEvidence& evidence = pair.evidence;
  const TrustConfig& trust = view.config.trust;
  const auto has_seen = [&](int observations, double observed_s) {
    return evidence.observations() >= observations && evidence.span_s() >= observed_s;
  };
  return (has_seen(trust.co_observations, trust.co_observed_s) ||
          has_seen(trust.slow_observations, trust.slow_observed_s)) &&
         evidence.is_nis_consistent() && evidence.is_speed_consistent(view.config.safe) &&
         evidence.level() <= view.config.safe.max_level && seen != nullptr && seen->is_sure &&
         ToSeconds(now - seen->track.support.last()) <= view.config.bridge.support_s;
}

std::optional<PriorityVehicle> Validate(const V2vView& view, SenderRecord& record,
                                        const ClaimInOdometry& here, bool is_ego_suspect,
                                        double yaw_sigma_rad) {
  const PriorityConfig& config = view.config;
  const PairTable::Pair* pair = view.pairs.AssignedTo(record.sender);
  if (pair == nullptr || view.list.Holds(pair->track_id) || record.shared.is_contested()) {
    return std::nullopt;
  }
  const TrackSnapshot* seen = view.tracks.Find(pair->track_id);
  if (seen == nullptr) return std::nullopt;
  const LocalTrack track = GivenClaimedSize(seen->track, &record, config.trust);
  // A new track near a bridged vehicle is probably that vehicle.
  if (view.list.HasAnotherAt(track.state_O.mean.head<2>(), record.sender, false)) {
    return std::nullopt;
  }
  const Timestamp last_hit = track.support.last();
  const bool is_hit = ToSeconds(here.stamp - last_hit) <= config.bridge.support_s;
  const PairEvidence& evidence = pair->evidence;
  if (!record.trust.TryValidate(
          {.stamp = here.stamp,
           .co_observations = evidence.observations(),
           .span_s = evidence.span_s(),
           .is_nis_consistent = evidence.is_nis_consistent(),
           .is_speed_consistent = evidence.is_speed_consistent(config.safe),
           .is_level_plausible = evidence.level() <= config.safe.max_level,
           .is_size_plausible =
               IsSizePlausible(record.length_m, record.width_m, seen->track.extent, config.trust),
           .margin = std::min(view.pairs.Margin(*pair), MarginOverUnseen(record, *pair)),
           .min_margin = config.safe.min_margin,
           .is_assigned = pair->is_assigned,
           .are_sensors_sure = seen->is_sure && is_hit,
           .is_ego_gnss_suspect = is_ego_suspect},
          config.trust)) {
    return std::nullopt;
  }
  const Timestamp frame = view.tracks.stamp();
  PriorityVehicle vehicle{
      .id = view.list.FreeId(track.id),
      .local_id = track.id,
      .sender = record.sender,
      .start = here.stamp,
      .filter = PriorityFilter(track.state_O, frame, evidence.bias(), evidence.bias_covariance(),
                               yaw_sigma_rad, config.filter),
      .coast = Coast(track.state_O, frame),
      .agreed = Coast(track.state_O, frame),
      .last_support = last_hit,
      .co_observed_s = evidence.span_s(),
      .last_v2v = here.stamp,
      .extent = track.extent,
      .object_class = track.object_class,
      .existence = track.existence,
      .support = track.support,
      .events = here.events};
  vehicle.PredictTo(here.stamp, config.filter);
  return vehicle;
}

}  // namespace v2vouch
