// SPDX-License-Identifier: Apache-2.0
// The radar half of the tracker: a scan's clusters met with the tracks.
#include <algorithm>
#include <utility>

#include "daemon/local/tracking/own_body.h"
#include "daemon/local/tracking/radar_candidates.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

// Detection probability of a scan in clear view.
constexpr double kClearLook = 0.4;
// For so long second echoes alone keep a vehicle.
constexpr double kEchoAlone_s = 1.0;
// ... and one that no picture has named.
constexpr double kUnnamedEchoAlone_s = 0.3;
// Where only pictures have seen a vehicle, a return within so many standard deviations and metres
// of its length may be its own.
constexpr double kEmptySigmas = 3.0;
constexpr double kEmptyBeyond_m = 2.0;
constexpr double kEmptyAside_m = 0.5;
constexpr int kMostEmptyLooks = 12;
// A vehicle that drove up and stopped has shown so many clusters of its own Doppler, so far apart.
constexpr int kDrivenHits = 10;
constexpr double kTravelled_m = 3.0;

}  // namespace

void Tracker::UpdateRadar(int radar, const EgoState& ego,
                          std::span<const RadarMeasurement> measurements,
                          const DetectabilityOf& detectability) {
  const RadarLook look{ego, vehicle_->radars[static_cast<std::size_t>(radar)]};
  const SensorKey sensor{SensorKind::kRadar, radar};
  clutter_.Age(radar);
  Begin(sensor, detectability);
  AddRadarCandidates(look, measurements, config_.birth_per_m2_s, table_, clutter_,
                     association_.candidates());
  CompareClusters(look, measurements);
  association_.Solve(measurements.size(), Proof::kRepeated, table_);
  CountEmptyLooks(look);
  owners_.Find(look, measurements, table_, association_);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (association_.GivenTo(i)) TakeCluster(look, sensor, i);
  }
  StartFromRadar(look, sensor, measurements);
  returns_.Keep(look, radar, measurements, association_.candidates(), owners_);
  roads_.Learn(ego, table_);
  Conclude();
}

void Tracker::CompareClusters(const RadarLook& look,
                              std::span<const RadarMeasurement> measurements) {
  const Candidates& candidates = association_.candidates();
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const auto [track, evidence] = table_[i];
    const double reach_m =
        CoarseReach(evidence.filter.position_covariance(), track.extent.length_m);
    // Long enough tried, a guess may meet standing returns by itself.
    const bool is_guess = !evidence.has_range;
    if (is_guess && evidence.glances.size() < Glances::kMost) continue;
    const bool takes_standing = track.camera_hits() + track.object_hits() > 0 ||
                                (evidence.moving_hits >= kDrivenHits && evidence.has_travelled);
    const bool is_echo_alone = ToSeconds(table_.now() - evidence.borne_out) >
                               (track.camera_hits() > 0 ? kEchoAlone_s : kUnnamedEchoAlone_s);
    candidates.ForEachNear(evidence.filter.position_O(), reach_m, [&](std::size_t j) {
      if (candidates[j].is_echo && is_echo_alone) return;
      if (measurements[j].is_static ? takes_standing : !is_guess) {
        association_.Compare(table_, i, j, look, measurements[j]);
      }
    });
  }
}

// What only pictures have seen, where this radar sees clearly: does anything at all reflect there?
void Tracker::CountEmptyLooks(const RadarLook& look) {
  // A sensor that tracks by itself reports what it has confirmed.
  if (look.radar.output == RadarOutput::kObjects) return;
  const Candidates& candidates = association_.candidates();
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const auto [track, evidence] = table_[i];
    if (track.radar_hits() + track.object_hits() > 0) continue;
    if (association_.expected().detection(i) < kClearLook) continue;
    const Eigen::Vector2d p_O = evidence.filter.position_O();
    const double sigma_m = LargestSigma(evidence.filter.position_covariance());
    const double along_m = kEmptySigmas * sigma_m + track.extent.length_m + kEmptyBeyond_m;
    const Eigen::Vector2d line = p_O - look.origin_O();
    const double range_m = line.norm();
    const double across_m = 0.5 * track.extent.length_m + kEmptyAside_m +
                            kEmptySigmas * look.radar.azimuth_sigma_rad * range_m;
    const Eigen::Vector2d u = line / std::max(range_m, 0.1);
    bool is_empty = true;
    candidates.ForEachNear(p_O, along_m + across_m, [&](std::size_t j) {
      const Eigen::Vector2d off = candidates[j].p_O - p_O;
      const double aside_m = std::abs(u.x() * off.y() - u.y() * off.x());
      is_empty = is_empty && !(std::abs(off.dot(u)) < along_m && aside_m < across_m);
    });
    evidence.empty_looks = is_empty ? std::min(evidence.empty_looks + 1, kMostEmptyLooks)
                                    : std::max(evidence.empty_looks - 2, 0);
  }
}

void Tracker::TakeCluster(const RadarLook& look, SensorKey sensor, std::size_t i) {
  const auto [track, evidence] = table_[i];
  const Candidate& given = association_.candidates()[*association_.GivenTo(i)];
  RadarMeasurement z = association_.expected().Given(i, table_, owners_.joined(i));
  z.may_be_anothers = evidence.filter.may_move_face() && IsInAnothersBox(table_, i, given.p_O);
  if (!evidence.filter.Update(look, z, table_.settings())) return table_.Fail(i);
  table_.NoteHit(i, sensor, given.is_echo);
  if (z.is_static) {
    // A post in the vehicle's place would have been seen as well.
    track.existence = std::min(track.existence, evidence.proven);
  } else {
    evidence.proven = std::max(evidence.proven, track.existence);
    ++evidence.moving_hits;
    if ((given.p_O - evidence.first_moving_O).norm() > kTravelled_m) evidence.has_travelled = true;
  }
  // A sensor that tracks by itself has sorted its mirror images out.
  if (z.is_object || association_.expected().detection(i) >= kClearLook) ++evidence.clear_hits;
  NoteReflection(look, i, given.p_O);
  evidence.has_range = true;
  updates_.push_back({track.id, z});
}

void Tracker::NoteReflection(const RadarLook& look, std::size_t i, const Eigen::Vector2d& p_O) {
  TrackEvidence& evidence = table_[i].evidence;
  evidence.reflection_O = p_O;
  evidence.reflected = table_.now();
  NoteOwnBody(*vehicle_, look, p_O, evidence);
}

// What no track explains starts one each.
void Tracker::StartFromRadar(const RadarLook& look, SensorKey sensor,
                             std::span<const RadarMeasurement> measurements) {
  const Candidates& candidates = association_.candidates();
  newcomers_.clear();
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (candidates[j].may_start && !owners_.IsOwned(j)) newcomers_.push_back(j);
  }
  // A scan of interference is no crowd of vehicles: the nearest count.
  if (KeepNearest(measurements, TrackTable::kMostNewcomers, newcomers_)) {
    table_.AddFault(Reason::kTrackTableFull);
  }
  const std::size_t known = table_.size();
  for (const std::size_t j : newcomers_) {
    // The first cluster of a newcomer swallows the others of the same scan.
    bool is_taken = false;
    for (std::size_t i = known; i < table_.size() && !is_taken; ++i) {
      is_taken = IsPartOf(std::as_const(table_)[i], look, measurements[j], candidates[j].p_O);
    }
    if (is_taken) continue;
    const TrackFilter filter = TrackFilter::FromRadar(look, measurements[j], table_.settings());
    if (!table_.Start(filter, sensor, j, association_.BirthExistence(j))) continue;
    const auto [track, evidence] = table_.back();
    evidence.moving_hits = 1;
    evidence.first_moving_O = candidates[j].p_O;
    evidence.clutter_cell = ClutterMap::CellOf(look.radar, measurements[j]);
    NoteReflection(look, table_.size() - 1, candidates[j].p_O);
    updates_.push_back({track.id, measurements[j]});
  }
}

}  // namespace v2vouch
