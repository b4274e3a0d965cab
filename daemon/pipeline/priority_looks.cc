// SPDX-License-Identifier: Apache-2.0
// What an own-sensor frame says of senders that no sensor vouches for, and of all senders together.
#include <algorithm>
#include <cmath>

#include "daemon/pipeline/local_perception.h"
#include "daemon/pipeline/priority_evidence.h"
#include "daemon/pipeline/priority_perception.h"

namespace v2vouch {
namespace {

constexpr double kMaxClaimAge_s = 0.4;  // An older claim says too little of where to look now.
constexpr double kHit_s = 0.35;         // A track hit so lately is there.
constexpr double kStanding_mps = 2.0;   // Standing returns may be a vehicle slower than this.
constexpr double kPlaceSigma_m = 0.3;
constexpr double kTakenSlack_m = -0.5;  // Another vehicle's place is taken well inside only.
constexpr double kTaken = 0.9;  // How surely a place is not free that another vehicle stands on.
constexpr double kResidual_s = 1.0;

bool WasHit(const LocalTrack& track, Timestamp now) {
  return ToSeconds(now - track.LastHit()) <= kHit_s;
}

}  // namespace

bool PriorityPerception::IsVouchedFor(const Link& link) const {
  const PairTable::Pair* pair = pairs_.AssignedTo(link.sender);
  if (pair == nullptr || IsHeldByAnother(pair->track_id, link.sender)) return false;
  return pair->evidence.level() <= settings_->priority.safe.max_level &&
         std::ranges::any_of(sensed_, [&](const Sensed& sensed) {
           return sensed.track.id == pair->track_id && WasHit(sensed.track, sensed_stamp_);
         });
}

bool PriorityPerception::IsRecent(const Link& link, Timestamp now) {
  return link.has_last && std::abs(ToSeconds(now - link.last.stamp)) <= kMaxClaimAge_s;
}

// Whether another sender claims the same place and motion, and the sensors see one vehicle there.
bool PriorityPerception::IsPlaceShared(const Link& link, Timestamp now) const {
  const SharedPlaceConfig& config = settings_->priority.trust.shared_place;
  const Eigen::Vector2d p_O = link.last.PlaceAt(now);
  const auto near_by = std::ranges::count_if(sensed_, [&](const Sensed& sensed) {
    return sensed.is_hit && (sensed.track.state_O.mean.head<2>() - p_O).norm() <= config.alone_m;
  });
  if (near_by != 1) return false;  // There are fewer tracks than senders: asked first.
  const Eigen::Vector2d v_O = link.last.velocity_O();
  return std::ranges::any_of(links_, [&](const Link& other) {
    return other.sender != link.sender && IsRecent(other, now) &&
           (other.last.PlaceAt(now) - p_O).norm() <= config.near_m &&
           (other.last.velocity_O() - v_O).norm() <= config.same_mps;
  });
}

void PriorityPerception::LookAtClaims(const LocalFrame& frame, const VisibilityMap& map,
                                      Outputs& outputs) {
  const TrustConfig& config = settings_->priority.trust;
  for (Link& link : links_) {
    if (const PriorityVehicle* vehicle = VehicleOf(link.sender)) {
      if (vehicle->is_supported) {
        link.place.OnVouched();
        continue;
      }
    }
    if (!IsRecent(link, frame.stamp) || IsOnAnotherLevel(link)) continue;
    if (!link.trust.is_relied_on()) {
      link.shared.OnLook(frame.stamp, IsPlaceShared(link, frame.stamp));
      if (const auto finding = link.shared.Judge(config.shared_place)) {
        link.trust.OnFinding(frame.stamp, *finding, false);
        Report(link, frame.stamp, outputs);
      }
    }
    if (!link.place.IsDue(frame.stamp, config.place)) continue;
    if (IsVouchedFor(link)) {
      link.place.OnVouched();
      if (!link.trust.is_relied_on()) link.unseen = LookBeside(link, frame, map);
      continue;
    }
    link.place.OnLook(frame.stamp, LookAround(link, frame, map), config.place);
    if (const auto finding = link.place.Judge(config.accuse_hold_s, config.place)) {
      link.trust.OnFinding(frame.stamp, *finding, MayAccuse(frame.stamp));
      Report(link, frame.stamp, outputs);
    }
  }
}

Occluder PriorityPerception::ClaimedFootprint(const Link& link, const Eigen::Vector2d& centre_O,
                                              double yaw_rad) {
  return {.centre_O = centre_O,
          .yaw_rad = yaw_rad,
          .length_m = link.length_m.value_or(4.5),
          .width_m = link.width_m.value_or(1.8),
          .position_sigma_m = kPlaceSigma_m};
}

std::array<ClaimedPlace::Look, ClaimedPlace::kPlaces> PriorityPerception::LookAround(
    const Link& link, const LocalFrame& frame, const VisibilityMap& map) const {
  const ClaimedPlaceConfig& config = settings_->priority.trust.place;
  std::array<ClaimedPlace::Look, ClaimedPlace::kPlaces> looks{};
  const ClaimInOdometry& claim = link.last;
  const Eigen::Vector2d p_O = claim.PlaceAt(frame.stamp);
  if ((p_O - frame.ego.X_OB.origin().vector()).norm() > config.max_distance_m) return looks;
  const double across_m = std::sqrt(config.bias_sigma_m * config.bias_sigma_m +
                                    0.5 * (claim.noise.trace() + claim.alignment.trace()));
  const double along_m = std::hypot(across_m, kStalePositionSigma_s * claim.speed_mps);
  const double c = std::cos(claim.yaw_rad);
  const double s = std::sin(claim.yaw_rad);
  std::array<Occluder, ClaimedPlace::kPlaces> footprints;
  for (std::size_t i = 0; i < footprints.size(); ++i) {
    const double x = along_m * ClaimedPlace::Places()[i].along;
    const double y = across_m * ClaimedPlace::Places()[i].across;
    footprints[i] =
        ClaimedFootprint(link, p_O + Eigen::Vector2d(c * x - s * y, s * x + c * y), claim.yaw_rad);
  }
  std::array<bool, ClaimedPlace::kPlaces> is_taken{};
  std::array<bool, ClaimedPlace::kPlaces> is_occupied{};
  for (const LocalTrack& track : frame.tracks) {
    if (!WasHit(track, frame.stamp)) continue;
    const StateMatrix& P = track.state_O.covariance;
    const bool is_taken_track =
        IsHeldByAnother(track.id, link.sender) || IsAnothers(track.id, link.sender);
    const double speed_mps =
        std::abs(std::abs(claim.speed_mps) - std::abs(track.state_O.mean[kSpeed]));
    if (!is_taken_track && speed_mps > config.slack_mps + std::sqrt(P(kSpeed, kSpeed))) continue;
    const double slack_m =
        is_taken_track ? kTakenSlack_m : config.slack_m + std::sqrt(0.5 * (P(kX, kX) + P(kY, kY)));
    auto& those = is_taken_track ? is_taken : is_occupied;
    for (std::size_t i = 0; i < footprints.size(); ++i) {
      those[i] = those[i] || AreClose(footprints[i], track, slack_m);
    }
  }
  const bool may_stand = std::abs(claim.speed_mps) < kStanding_mps;
  const auto clear_to = [&](ClearTo whom, const Occluder& footprint) {
    return ClearDetection(footprint, frame, map, settings_->vehicle, whom,
                          settings_->priority.bridge.least_detection);
  };
  // Whether the claimed place itself can be judged decides for its surroundings, too.
  const auto claimed = clear_to(ClearTo::kBothKinds, footprints[0]);
  for (std::size_t i = 0; i < footprints.size(); ++i) {
    if (is_occupied[i] ||
        (may_stand && map.HasStandingReturn(footprints[i].centre_O, kStandingReach_m))) {
      looks[i].seen = ClaimedPlace::Seen::kOccupied;
    } else if (is_taken[i]) {
      looks[i] = {ClaimedPlace::Seen::kEmpty, kTaken};
    } else if (claimed) {
      const auto detection = i == 0 ? claimed : clear_to(ClearTo::kAnySensor, footprints[i]);
      if (detection) looks[i] = {ClaimedPlace::Seen::kEmpty, *detection};
    }
  }
  return looks;
}

void PriorityPerception::JudgeCommonMode(Timestamp now) {
  residual_means_.clear();
  for (const Link& link : links_) {
    const ResidualHistory& history = link.trust.history();
    if (!history.is_settled() || ToSeconds(now - history.last()) > kResidual_s) continue;
    residual_means_.push_back({link.sender, history.mean_O()});
  }
  const CommonModeConfig& config = settings_->priority.trust.common_mode;
  const CommonMode seen(residual_means_, config);
  if (seen.is_shifted()) {
    shifted_ = now;
    common_ = seen;
  } else if (!IsShifted(now)) {
    common_ = seen;
  }
}

bool PriorityPerception::IsShifted(Timestamp now) const {
  return shifted_ && ToSeconds(now - *shifted_) <= settings_->priority.trust.common_mode.hold_s;
}

// Not validated yet, or never: but the track is sooner this other sender's than anybody else's.
bool PriorityPerception::IsAnothers(std::uint64_t local_id, SenderId sender) const {
  return std::ranges::any_of(pairs_.pairs(), [&](const PairTable::Pair& pair) {
    if (pair.track_id != local_id || pair.sender == sender || !pair.is_assigned) return false;
    if (pair.evidence.observations() < settings_->priority.trust.co_observations) return false;
    const TrustState state = TrustOf(pair.sender);
    return state != TrustState::kSuspect && state != TrustState::kRevoked;
  });
}

bool PriorityPerception::IsHeldByAnother(std::uint64_t local_id, SenderId sender) const {
  return std::ranges::any_of(vehicles_, [&](const PriorityVehicle& vehicle) {
    return vehicle.id != 0 && vehicle.is_supported && vehicle.local_id == local_id &&
           vehicle.sender != sender;
  });
}

}  // namespace v2vouch
