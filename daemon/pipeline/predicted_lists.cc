// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/predicted_lists.h"

#include <algorithm>

#include "daemon/common/models/ctra.h"

namespace v2vouch {
namespace {

// What is not known of the ego's own motion `gap_s` after its last sample, for lists that are read
// from the ego: it may have braked or steered since. Accelerations of 2 m/s^2 either way are one
// sigma, and so is a change of the yaw rate by 0.1 rad/s in a second.
StateMatrix EgoDriftCovariance(double gap_s) {
  constexpr double kAccelSigma_mps2 = 2.0;
  constexpr double kYawAccelSigma_radps2 = 0.1;
  const double position_m = 0.5 * kAccelSigma_mps2 * gap_s * gap_s;
  const double yaw_rad = 0.5 * kYawAccelSigma_radps2 * gap_s * gap_s;
  StateMatrix doubt = StateMatrix::Zero();
  doubt(kX, kX) = doubt(kY, kY) = position_m * position_m;
  doubt(kYaw, kYaw) = yaw_rad * yaw_rad;
  return doubt;
}

}  // namespace

void ListLocal(const LocalFrame& frame, std::int64_t seq, int revision, TrackList& list) {
  list.stamp = frame.stamp;
  list.seq = seq;
  list.revision = revision;
  list.stale = false;
  list.ego_gnss_suspect = false;  // GNSS is none of LOCAL's business.
  list.X_OB = frame.ego.X_OB;
  list.sectors = frame.sectors;
  list.tracks.clear();
  for (const LocalTrack& track : frame.tracks) {
    if (track.is_confirmed) list.tracks.push_back({.track = track});
  }
}

void PredictLists(const Timeline& timeline, const PerceptionConfig& config, Timestamp at,
                  Outputs& outputs) {
  const LocalFrame& frame = *timeline.newest_frame();
  outputs.has_lists = true;
  const EgoOdometry& odometry = timeline.local().odometry();
  const double hold_s = config.timeline.stale_hold_s;
  const Timestamp end = frame.stamp + FromSeconds(hold_s);
  // The ego is predicted like all vehicles; past the end its pose is of no use.
  const auto ego_at = [&](Timestamp t) {
    const double longest_gap_s = EgoOdometry::kMaxGap_s + hold_s;
    return odometry.StateAt(std::min(t, end), longest_gap_s).value_or(frame.ego);
  };
  const auto doubt = [&](Timestamp t) {
    const Timestamp known = odometry.newest().value_or(frame.stamp);
    return EgoDriftCovariance(std::max(0.0, ToSeconds(std::min(t, end) - known)));
  };

  outputs.local.stamp = at;
  outputs.local.stale = true;
  outputs.local.X_OB = ego_at(at).X_OB;
  for (SectorHealth& sector : outputs.local.sectors) sector.state = SectorState::kBlind;

  const Timestamp at_v2v = std::max(at, timeline.newest_time());
  const EgoState ego_v2v = ego_at(at_v2v);
  outputs.priority = outputs.local;
  outputs.priority.stamp = at_v2v;
  outputs.priority.X_OB = ego_v2v.X_OB;
  outputs.priority.tracks.clear();
  outputs.priority.ego_gnss_suspect = timeline.priority().is_ego_gnss_suspect();

  // No sensor supports any track any more: the list is empty and all sectors are blind, which is
  // not the same as "nothing there".
  if (at > end) {
    outputs.local.tracks.clear();
    return;
  }
  for (PublishedTrack& line : outputs.local.tracks) {
    PredictCtra(line.track.state_O, ToSeconds(at - frame.stamp), config.tracking.motion);
    line.track.state_O.covariance += doubt(at);
  }
  timeline.priority().Publish(at_v2v, ego_v2v, outputs.priority);
  for (PublishedTrack& line : outputs.priority.tracks) {
    line.track.state_O.covariance += doubt(at_v2v);
  }
}

}  // namespace v2vouch
