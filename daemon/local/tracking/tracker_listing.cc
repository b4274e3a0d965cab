// SPDX-License-Identifier: Apache-2.0
// What is listed, and for how long: the end of each of the tracker's frames.
#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/common/models/extent.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

// Unpublished tracks go below this.
constexpr double kForget = 1e-5;
// In view, a vehicle is missed for no longer than this.
constexpr double kOverdue_s = 0.7;
// What is faster than this drives along its lane; what is shorter than this walks or cycles.
constexpr double kDrives_mps = 3.0;
constexpr double kWalks_m = 2.0;
// More that are not listed are not kept: every one of them costs as much as a vehicle.
constexpr std::size_t kMostGuesses = 128;

}  // namespace

// Existence must outweigh the error that the cut-off metric would find.
bool Tracker::IsWorthListing(std::size_t track) const {
  const double c2 = config_.list_cutoff_m * config_.list_cutoff_m;
  const double m = hidden_[track].filter.position_covariance().trace();
  const double error = m > 0.0 ? -m * std::expm1(-c2 / m) : 0.0;
  return tracks_[track].existence * 2.0 * (c2 - error) > c2;
}

// Nothing is known to hide it, and no sensor has seen it for a while.
bool Tracker::IsOverdue(std::size_t track) const {
  return tracks_[track].visibility == Visibility::kVisible &&
         ToSeconds(now_ - hidden_[track].last_hit) > kOverdue_s;
}

// Ways of those that drive, the ego's among them.
void Tracker::LearnRoad(const EgoState& ego) {
  if (ego.speed_mps > kDrives_mps) {
    roads_.Note(ego.X_OB.origin().vector(), ego.X_OB.yaw_rad());
  }
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const LocalTrack& track = tracks_[i];
    if (!track.is_confirmed || !hidden_[i].filter.has_driven()) continue;
    if (hidden_[i].last_hit != now_) continue;
    if (ClassExtent(track.object_class).length_m < kWalks_m) continue;
    const Eigen::Vector2d velocity = hidden_[i].filter.velocity_O();
    if (velocity.norm() < kDrives_mps) continue;
    roads_.Note(hidden_[i].filter.position_O(), std::atan2(velocity.y(), velocity.x()));
  }
}

void Tracker::FaceAsTheRoad(std::size_t track) {
  TrackFilter& filter = hidden_[track].filter;
  if (!filter.is_vehicle() || filter.has_driven()) return;
  if (settings_.point_targets || hidden_[track].last_hit != now_) return;
  const double axis_rad = tracks_[track].state_O.mean[kYaw];
  if (const auto yaw = roads_.DirectionAt(filter.position_O(), axis_rad)) {
    filter.FaceTowards(*yaw);
  }
}

// Shows the new states, confirms, ends and puts in order.
void Tracker::Conclude(double dt_s) {
  since_update_s_ = 0.0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    LocalTrack& track = tracks_[i];
    Hidden& hidden = hidden_[i];
    FaceAsTheRoad(i);
    hidden.filter.Show(settings_, track);
    if (!track.state_O.mean.allFinite() || !track.state_O.covariance.allFinite()) {
      failures_.push_back(Reason::kTrackNumerics);
      hidden.is_dead = true;
      continue;
    }
    const int hits = Hits(i);
    if (!track.is_confirmed && IsConvincing(i)) {
      track.is_confirmed = true;
    } else if (track.is_confirmed && (track.existence < config_.keep_existence ||
                                      !IsWorthListing(i) || IsTransparent(i) || IsOverdue(i))) {
      track.is_confirmed = false;
    }
    const bool was_believed = hits >= config_.confirm_hits;
    if (track.existence < (was_believed ? config_.delete_existence : kForget)) {
      hidden.is_dead = true;
    }
  }
  DropDuplicates(dt_s);
  JoinParts(dt_s);
  DropUnlikely();
  RemoveDead();
  // Births come in order of their index; only two sensors with one stamp can need more than this.
  for (std::size_t i = 1; i < tracks_.size(); ++i) {
    for (std::size_t k = i; k > 0 && tracks_[k].id < tracks_[k - 1].id; --k) {
      std::swap(tracks_[k], tracks_[k - 1]);
      std::swap(hidden_[k], hidden_[k - 1]);
    }
  }
}

// Of many tracks that are not listed the likeliest stay.
void Tracker::DropUnlikely() {
  newcomers_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const bool may_go = !tracks_[i].is_confirmed && !hidden_[i].is_certain;
    if (may_go && !hidden_[i].is_dead) newcomers_.push_back(static_cast<int>(i));
  }
  if (newcomers_.size() <= kMostGuesses) return;
  std::ranges::sort(newcomers_, {}, [&](int i) {
    const LocalTrack& track = tracks_[static_cast<std::size_t>(i)];
    return std::pair(-track.existence, track.id);
  });
  for (std::size_t k = kMostGuesses; k < newcomers_.size(); ++k) {
    hidden_[static_cast<std::size_t>(newcomers_[k])].is_dead = true;
  }
  failures_.push_back(Reason::kTrackTableFull);
}

void Tracker::ForgetUnpicturedSince(Timestamp since) {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i].start < since) continue;
    if (tracks_[i].camera_hits() + tracks_[i].object_hits() == 0) hidden_[i].is_dead = true;
  }
  RemoveDead();
  std::erase_if(recent_, [](const RecentReturn& at) { return at.is_moving; });
}

void Tracker::RemoveDead() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (hidden_[i].is_dead) continue;
    if (kept != i) {
      tracks_[kept] = tracks_[i];
      hidden_[kept] = hidden_[i];
    }
    ++kept;
  }
  tracks_.resize(kept);
  hidden_.resize(kept);
}

}  // namespace v2vouch
