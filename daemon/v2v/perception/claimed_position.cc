// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/claimed_position.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/v2v/perception/evidence.h"

namespace v2vouch {
namespace {

// A car's size, where none is claimed.
constexpr double kClaimSigma_m = 0.3;      // Blur of a claimed footprint.
constexpr double kStanding_mps = 2.0;      // Stationary returns may be a slower vehicle.
constexpr double kStandingReach_m = 2.0;   // Stationary returns so near may be the vehicle.
constexpr double kOccupiedSlack_m = -0.5;  // Another vehicle's position: well inside only.
constexpr double kOccupied = 0.9;          // Detection probability where another one stands.
constexpr double kQueueGap_m = 2.0;        // Between bumpers of two that stand in a queue ...
constexpr double kHeadway_s = 0.8;         // ... and so much more where they drive.

// The positions that the sender may really be at, as footprints.
std::array<Occluder, ClaimedPlace::kPlaces> PossibleFootprints(const SenderRecord& record,
                                                               const Eigen::Vector2d& p_O,
                                                               const ClaimedPlaceConfig& config) {
  const ClaimInOdometry& claim = record.last;
  const double across_m = std::sqrt(config.bias_sigma_m * config.bias_sigma_m +
                                    0.5 * (claim.noise.trace() + claim.alignment.trace()));
  const double along_m = std::hypot(across_m, kStalePositionSigma_s * claim.speed_mps);
  const double c = std::cos(claim.yaw_rad);
  const double s = std::sin(claim.yaw_rad);
  std::array<Occluder, ClaimedPlace::kPlaces> footprints;
  for (std::size_t i = 0; i < footprints.size(); ++i) {
    const double x = along_m * ClaimedPlace::Places()[i].along;
    const double y = across_m * ClaimedPlace::Places()[i].across;
    footprints[i] = ClaimedFootprint(record, p_O + Eigen::Vector2d(c * x - s * y, s * x + c * y),
                                     claim.yaw_rad);
  }
  return footprints;
}

}  // namespace

Occluder ClaimedFootprint(const SenderRecord& record, const Eigen::Vector2d& centre_O,
                          double yaw_rad) {
  return {.centre_O = centre_O,
          .yaw_rad = yaw_rad,
          .length_m = record.length_m.value_or(kUsualLength_m),
          .width_m = record.width_m.value_or(kUsualWidth_m),
          .position_sigma_m = kClaimSigma_m};
}

std::array<ClaimedPlace::Look, ClaimedPlace::kPlaces> ObserveClaimedPosition(
    const V2vView& view, const SenderRecord& record, const LocalFrame& frame,
    const VisibilityMap& map) {
  const ClaimedPlaceConfig& config = view.config.trust.place;
  std::array<ClaimedPlace::Look, ClaimedPlace::kPlaces> looks{};
  const ClaimInOdometry& claim = record.last;
  const Eigen::Vector2d p_O = claim.PlaceAt(frame.stamp);
  if ((p_O - frame.ego.X_OB.origin().vector()).norm() > config.max_distance_m) return looks;
  const auto footprints = PossibleFootprints(record, p_O, config);
  std::array<bool, ClaimedPlace::kPlaces> is_anothers{};
  std::array<bool, ClaimedPlace::kPlaces> is_occupied{};
  for (const LocalTrack& track : frame.tracks) {
    if (!WasHitLately(track, frame.stamp)) continue;
    const StateMatrix& P = track.state_O.covariance;
    const bool is_anothers_track = IsAnothers(view, track.id, record.sender);
    const double speed_mps =
        std::abs(std::abs(claim.speed_mps) - std::abs(track.state_O.mean[kSpeed]));
    if (!is_anothers_track && speed_mps > config.slack_mps + std::sqrt(P(kSpeed, kSpeed))) continue;
    const double slack_m = is_anothers_track
                               ? kOccupiedSlack_m
                               : config.slack_m + std::sqrt(0.5 * (P(kX, kX) + P(kY, kY)));
    auto& those = is_anothers_track ? is_anothers : is_occupied;
    for (std::size_t i = 0; i < footprints.size(); ++i) {
      those[i] = those[i] || AreClose(footprints[i], track, slack_m);
    }
  }
  const bool may_stand = std::abs(claim.speed_mps) < kStanding_mps;
  const auto clear_to = [&](ClearTo whom, const Occluder& footprint) {
    return ClearDetection(footprint, frame, map, view.vehicle, whom,
                          view.config.bridge.least_detection);
  };
  // Whether the claimed position itself can be judged decides for its surroundings, too.
  const auto claimed = clear_to(ClearTo::kEveryKind, footprints[0]);
  for (std::size_t i = 0; i < footprints.size(); ++i) {
    if (is_occupied[i] ||
        (may_stand && map.HasStandingReturn(footprints[i].centre_O, kStandingReach_m))) {
      looks[i].seen = ClaimedPlace::Seen::kOccupied;
    } else if (is_anothers[i]) {
      looks[i] = {ClaimedPlace::Seen::kEmpty, kOccupied};
    } else if (claimed) {
      const auto detection = i == 0 ? claimed : clear_to(ClearTo::kAnySensor, footprints[i]);
      if (detection) looks[i] = {ClaimedPlace::Seen::kEmpty, *detection};
    }
  }
  return looks;
}

bool IsPositionShared(const V2vView& view, const SenderRecord& record, Timestamp now) {
  const SharedPlaceConfig& config = view.config.trust.shared_place;
  const Eigen::Vector2d p_O = record.last.PlaceAt(now);
  // There are fewer tracks than senders: they are asked first.
  const auto near_by =
      std::ranges::count_if(view.tracks.tracks(), [&](const TrackSnapshot& snapshot) {
        return snapshot.is_hit &&
               (snapshot.track.state_O.mean.head<2>() - p_O).norm() <= config.alone_m;
      });
  if (near_by != 1) return false;
  const Eigen::Vector2d v_O = record.last.velocity_O();
  return std::ranges::any_of(view.senders.records(), [&](const SenderRecord& other) {
    return other.sender != record.sender && other.IsRecent(now) &&
           (other.last.PlaceAt(now) - p_O).norm() <= config.near_m &&
           (other.last.velocity_O() - v_O).norm() <= config.same_mps;
  });
}

UnseenNeighbours FindUnseenNeighbours(const V2vView& view, const SenderRecord& record,
                                      const LocalFrame& frame, const VisibilityMap& map) {
  UnseenNeighbours unseen;
  const PairTable::Pair* pair = view.pairs.AssignedTo(record.sender);
  const TrackSnapshot* seen = pair == nullptr ? nullptr : view.tracks.Find(pair->track_id);
  if (seen == nullptr) return unseen;
  unseen.track_id = pair->track_id;
  const StateVector& track = seen->track.state_O.mean;
  // Of a track that has never moved the direction is a guess; the sender knows its own.
  const double yaw_rad = record.last.has_course ? record.last.yaw_rad : track[kYaw];
  Occluder footprint = ClaimedFootprint(record, track.head<2>(), yaw_rad);
  const double apart_m = 0.5 * (seen->track.extent.length_m + footprint.length_m) + kQueueGap_m +
                         kHeadway_s * std::abs(track[kSpeed]);
  const Eigen::Vector2d ahead(std::cos(yaw_rad), std::sin(yaw_rad));
  for (std::size_t i = 0; i < unseen.offsets_O.size(); ++i) {
    const Eigen::Vector2d offset_O = (i == 0 ? apart_m : -apart_m) * ahead;
    footprint.centre_O = track.head<2>() + offset_O;
    // A LOCAL track at that position is a pair of its own.
    const bool is_tracked =
        std::ranges::any_of(view.tracks.tracks(), [&](const TrackSnapshot& other) {
          return other.track.id != pair->track_id && other.is_hit &&
                 AreClose(footprint, other.track, 0.0);
        });
    if (is_tracked) continue;
    const bool is_clear =
        ClearDetection(footprint, frame, map, view.vehicle, ClearTo::kAnySensor, 0.0).has_value();
    if (is_clear && !map.HasStandingReturn(footprint.centre_O, kStandingReach_m)) continue;
    unseen.offsets_O[i] = offset_O;
  }
  return unseen;
}

double MarginOverUnseen(const SenderRecord& record, const PairTable::Pair& pair) {
  if (record.unseen.track_id != pair.track_id) return 0.0;
  double margin = std::numeric_limits<double>::infinity();
  for (const auto& offset_O : record.unseen.offsets_O) {
    if (!offset_O) continue;
    margin = std::min(margin, pair.evidence.LevelBeside(*offset_O) - pair.evidence.level());
  }
  return margin;
}

}  // namespace v2vouch
