// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/association/paper_list.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "daemon/v2v/association/paper.h"

namespace v2vouch {
namespace {

// The claim carried to `stamp` along its own arc; good enough over a beacon interval.
StateVector ClaimAt(const ClaimInOdometry& claim, Timestamp stamp) {
  const double dt_s = std::max(0.0, ToSeconds(stamp - claim.stamp));
  const double middle_rad = claim.yaw_rad + 0.5 * claim.yaw_rate_radps * dt_s;
  StateVector x;
  x << claim.p_O.x() + claim.speed_mps * dt_s * std::cos(middle_rad),
      claim.p_O.y() + claim.speed_mps * dt_s * std::sin(middle_rad),
      claim.yaw_rad + claim.yaw_rate_radps * dt_s, claim.speed_mps, claim.yaw_rate_radps,
      claim.accel_mps2;
  return x;
}

void FusePosition(const StateVector& claimed, double sigma_m, KinematicState& state) {
  const Eigen::Matrix2d P = state.covariance.topLeftCorner<2, 2>();
  const Eigen::Matrix2d C = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d K = P * (P + C).inverse();
  const Eigen::Vector2d step = K * (claimed.head<2>() - state.mean.head<2>());
  state.mean.head<2>() += step;
  state.covariance.topLeftCorner<2, 2>() = K * C;
}

KinematicState FromClaimAlone(const StateVector& claimed, double sigma_m) {
  KinematicState state;
  state.mean = claimed;
  state.covariance.diagonal() << sigma_m * sigma_m, sigma_m * sigma_m, 0.01, 0.25, 0.01, 0.25;
  return state;
}

std::uint64_t IdOf(std::uint64_t local_id, SenderId sender) {
  std::uint64_t z = local_id * 0x9E3779B97F4A7C15ULL + sender;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  return (z ^ (z >> 31)) >> 1 | 1;
}

}  // namespace

void PaperList::OnClaim(const ClaimInOdometry& claim, const PaperConfig& config) {
  std::erase_if(claims_, [&](const ClaimInOdometry& old) {
    return ToSeconds(claim.stamp - old.stamp) > config.keep_alive_s;
  });
  const auto at = std::ranges::lower_bound(claims_, claim.sender, {}, &ClaimInOdometry::sender);
  if (at != claims_.end() && at->sender == claim.sender) {
    *at = claim;
  } else if (claims_.size() < kMaxClaims) {
    claims_.insert(at, claim);
  }
}

void PaperList::OnFrame(Timestamp stamp, std::span<const LocalTrack> tracks,
                        const PaperConfig& config) {
  std::vector<const LocalTrack*> sensed;
  std::vector<Eigen::Vector3d> S, V;
  for (const LocalTrack& track : tracks) {
    if (!track.is_confirmed) continue;
    sensed.push_back(&track);
    S.emplace_back(track.state_O.mean[kX], track.state_O.mean[kY], 0.0);  // Z: flat ground.
  }
  for (const ClaimInOdometry& claim : claims_) {
    const StateVector x = ClaimAt(claim, stamp);
    V.emplace_back(x[kX], x[kY], 0.0);
  }
  const double sigma_m = config.position_sigma_m;
  const Eigen::Matrix3d C = sigma_m * sigma_m * Eigen::Matrix3d::Identity();

  for (Entry& entry : entries_) entry.local_id = 0;
  for (const PaperPair& pair : AssociatePaper(S, V, C, config.epsilon)) {
    const LocalTrack& s = *sensed[pair.sensor];
    const ClaimInOdometry& v = claims_[pair.v2v];
    // A sender's own track that lost its LOCAL one takes the new one; else the pair is a new track.
    const std::uint64_t id = IdOf(s.id, v.sender);
    auto entry = std::ranges::find(entries_, id, &Entry::id);
    if (entry == entries_.end()) {
      entry = std::ranges::find_if(entries_, [&](const Entry& old) {
        return old.sender == v.sender && old.local_id == 0 && old.stamp < stamp &&
               std::ranges::find(sensed, old.track.id, &LocalTrack::id) == sensed.end();
      });
    }
    if (entry == entries_.end()) {
      entries_.push_back({id, v.sender, 0, {}, {}, {}});
      entry = entries_.end() - 1;
    }
    entry->local_id = s.id;
    entry->track = s;
    entry->stamp = stamp;
    entry->last_v2v = v.stamp;
    FusePosition(ClaimAt(v, stamp), sigma_m, entry->track.state_O);
  }
  for (Entry& entry : entries_) {
    if (entry.local_id != 0) continue;
    const auto v = std::ranges::find(claims_, entry.sender, &ClaimInOdometry::sender);
    if (v == claims_.end()) continue;
    entry.last_v2v = v->stamp;
    entry.stamp = stamp;
    entry.track.state_O = FromClaimAlone(ClaimAt(*v, stamp), sigma_m);
    entry.track.visibility = Visibility::kHidden;
  }
  std::erase_if(entries_, [&](const Entry& entry) {
    return ToSeconds(stamp - entry.last_v2v) > config.keep_alive_s;
  });
  std::ranges::sort(entries_, {}, &Entry::id);
}

}  // namespace v2vouch
