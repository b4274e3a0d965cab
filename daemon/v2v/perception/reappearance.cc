// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/reappearance.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/v2v/perception/evidence.h"

namespace v2vouch {
namespace {

constexpr double kReturnGate = 13.8;    // Chi-square, 2 dof, 0.999.
constexpr double kReturnFloor_m = 0.7;  // Extent and reference point of a young track.
constexpr double kReturnSpeed_mps = 4.0;
// How far a vehicle that comes back may be from where its sender says, bias taken off: less across
// than along, where lanes lie and where the sender's own age of position does not reach. Twice the
// track's sigma comes on top, but a track known worse than kMostDoubt is never accepted.
constexpr double kClaimedAlong_m = 2.5;
constexpr double kClaimedAcross_m = 1.2;
constexpr double kClaimedSpeed_mps = 2.5;
constexpr double kMostDoubt_m = 1.5;
constexpr double kMostDoubt_mps = 1.5;
constexpr double kSlack_s = 0.5;     // A track born so long before the loss may be the vehicle.
constexpr double kPatience_s = 0.5;  // Hits of a return may lie so far apart.
// The reach of the coast is capped for an unseen vehicle; a car that is seen again and has sped up
// or turned meanwhile may be farther off.
constexpr double kSeenReach = 1.5;
// A coast less certain than this contradicts no track.
constexpr double kUsefulCoast_m = 4.0;
constexpr double kCoastGate = 9.21;
constexpr double kSameSpeed_mps = 3.0;
constexpr double kSameYaw_rad = FromDegrees(30.0);

// What bounds a phantom need not bound a vehicle that the sensors see.
BridgeConfig SeenReach(BridgeConfig config) {
  config.reach_most_m *= kSeenReach;
  return config;
}

// The track that a vehicle may come back as: its own, or a new one that no vehicle rests on.
bool MayBeItsTrack(const V2vView& view, const PriorityVehicle& vehicle, const LocalTrack& track) {
  if (track.id == vehicle.local_id) return true;
  return !view.list.Holds(track.id) && (track.id == vehicle.former_local_id ||
                                        ToSeconds(vehicle.last_support - track.start) <= kSlack_s);
}

double GateDistance(const Eigen::Vector2d& d, const Eigen::Matrix2d& S) {
  return d.dot(S.inverse() * d);
}

}  // namespace

bool IsWhereClaimed(const V2vView& view, const LocalTrack& track, const PriorityVehicle& vehicle,
                    Timestamp stamp) {
  const SenderRecord* record = view.senders.Find(vehicle.sender);
  if (record == nullptr) return true;
  const ClaimInOdometry& claim = record->last;
  const bool is_fresh = record->has_last && std::abs(ToSeconds(stamp - claim.stamp)) <= kPatience_s;
  const KinematicState carried = vehicle.filter.kinematics();
  const bool has_course = !is_fresh || claim.has_course;
  const double speed_mps = is_fresh ? claim.speed_mps : carried.mean[kSpeed];
  double yaw_rad = is_fresh ? claim.yaw_rad : carried.mean[kYaw];
  if (!has_course) yaw_rad = track.state_O.mean[kYaw];
  const Eigen::Vector2d place_O =
      is_fresh ? Eigen::Vector2d(claim.PlaceAt(stamp) - vehicle.filter.bias())
               : Eigen::Vector2d(carried.mean.head<2>());
  const Eigen::Matrix2d noise =
      is_fresh ? claim.noise : Eigen::Matrix2d(carried.covariance.topLeftCorner<2, 2>());
  const Eigen::Vector2d off_O = place_O - track.state_O.mean.head<2>();
  const Eigen::Vector2d ahead(std::cos(yaw_rad), std::sin(yaw_rad));
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  const Eigen::Matrix2d P = noise + track.state_O.covariance.topLeftCorner<2, 2>();
  const double along_sigma_m = std::sqrt(ahead.dot(P * ahead));
  const double across_sigma_m = std::sqrt(left.dot(P * left));
  if (std::max(along_sigma_m, across_sigma_m) > kMostDoubt_m) return false;
  if (std::abs(ahead.dot(off_O)) > kClaimedAlong_m + 2.0 * along_sigma_m) return false;
  if (std::abs(left.dot(off_O)) > kClaimedAcross_m + 2.0 * across_sigma_m) return false;
  if (!has_course) return true;
  const double yaw_mps = std::sqrt(track.state_O.covariance(kYaw, kYaw)) * speed_mps;
  const double speed_sigma_mps = std::sqrt(track.state_O.covariance(kSpeed, kSpeed));
  return (speed_mps * ahead - track.state_O.velocity()).norm() <=
         kClaimedSpeed_mps + 2.0 * std::min(std::hypot(speed_sigma_mps, yaw_mps), kMostDoubt_mps);
}

bool IsReappearing(const PriorityVehicle& vehicle, Timestamp stamp, const BridgeConfig& config) {
  return vehicle.regaining_id != 0 && ToSeconds(stamp - vehicle.last_regain) <= kPatience_s &&
         vehicle.CanReach(vehicle.filter.mean().head<2>(), stamp, SeenReach(config));
}

bool UpdateReappearance(const V2vView& view, PriorityVehicle& vehicle, Timestamp stamp) {
  const BridgeConfig& config = view.config.bridge;
  const KinematicState here = vehicle.filter.kinematics();
  const TrackSnapshot* best = nullptr;
  double best_distance = kReturnGate;
  for (const TrackSnapshot& snapshot : view.tracks.tracks()) {
    const LocalTrack& track = snapshot.track;
    if (!snapshot.is_hit) continue;
    if (!MayBeItsTrack(view, vehicle, track)) continue;
    const Eigen::Vector2d p_O = track.state_O.mean.head<2>();
    if (!vehicle.CanReach(p_O, stamp, SeenReach(config))) continue;
    const double speed = std::abs(here.mean[kSpeed]) - std::abs(track.state_O.mean[kSpeed]);
    const double speed_sigma = std::sqrt(track.state_O.covariance(kSpeed, kSpeed));
    if (std::abs(speed) > kReturnSpeed_mps + 2.0 * speed_sigma) continue;
    if (!IsWhereClaimed(view, track, vehicle, stamp)) continue;
    const Eigen::Matrix2d S = here.covariance.topLeftCorner<2, 2>() +
                              track.state_O.covariance.topLeftCorner<2, 2>() +
                              kReturnFloor_m * kReturnFloor_m * Eigen::Matrix2d::Identity();
    const double distance = GateDistance(p_O - here.mean.head<2>(), S);
    if (distance < best_distance) {
      best_distance = distance;
      best = &snapshot;
    }
  }
  if (best == nullptr) return false;
  const bool continues = vehicle.regaining_id == best->track.id &&
                         ToSeconds(stamp - vehicle.last_regain) <= kPatience_s;
  vehicle.regained_hits = continues ? vehicle.regained_hits + 1 : 1;
  vehicle.regaining_id = best->track.id;
  vehicle.last_regain = stamp;
  vehicle.empty.OnHit();
  if (vehicle.regained_hits < config.regain_hits) return false;
  vehicle.local_id = best->track.id;
  vehicle.is_supported = true;
  vehicle.visibility = Visibility::kVisible;
  vehicle.last_support = stamp;
  vehicle.coast = Coast(best->track.state_O, stamp);
  vehicle.agreed = Coast(vehicle.filter.kinematics(), stamp);
  vehicle.regaining_id = 0;
  return true;
}

std::optional<Finding> FindSeenElsewhere(const V2vView& view, PriorityVehicle& vehicle,
                                         Timestamp stamp) {
  const BridgeConfig& config = view.config.bridge;
  if (vehicle.regaining_id != 0 && ToSeconds(stamp - vehicle.last_regain) <= kPatience_s) {
    return std::nullopt;
  }
  const KinematicState& coast = vehicle.coast.state();
  if (PositionSigma(coast) > kUsefulCoast_m) return std::nullopt;
  const KinematicState here = vehicle.filter.kinematics();
  for (const TrackSnapshot& snapshot : view.tracks.tracks()) {
    const LocalTrack& track = snapshot.track;
    if (!snapshot.is_hit || track.support.hits() < config.regain_hits) continue;
    const bool is_own = track.id == vehicle.local_id;
    if (!is_own &&
        (view.list.Holds(track.id) || ToSeconds(vehicle.last_support - track.start) > kSlack_s)) {
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
    const bool is_somebody_else = std::ranges::any_of(view.pairs.pairs(), [&](const auto& pair) {
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
    return Finding{Check::kSeenElsewhere, Verdict::kWithdraw, "distance_m", apart_m,
                   config.contradiction_m};
  }
  return std::nullopt;
}

}  // namespace v2vouch
