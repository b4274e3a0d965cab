// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/track_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/local/tracking/existence.h"

namespace v2vouch {
namespace {

// What a vehicle was called is remembered for some twenty pictures: a name that was wrong for a
// while is overcome as fast.
constexpr double kVoteMemory = 0.95;
constexpr double kLeastVote = 0.05;
constexpr double kClearlyBetter = 1.5;
// More that are not listed are not kept: every one of them costs as much as a vehicle.
constexpr std::size_t kMostGuesses = 128;

bool IsPossible(const LocalTrack& track) {
  return track.state_O.mean.allFinite() && track.state_O.covariance.allFinite() &&
         track.state_O.covariance.diagonal().minCoeff() >= 0.0 && track.existence >= 0.0 &&
         track.existence <= 1.0;
}

}  // namespace

std::uint64_t TrackTable::PackId(Timestamp stamp, SensorKey sensor, std::size_t index) {
  constexpr unsigned kDetectionBits = 12;
  constexpr unsigned kSensorBits = 5;
  constexpr unsigned kKindBits = 2;
  constexpr unsigned kUnit_us_bits = 9;
  static_assert(kMostDetections == std::size_t{1} << kDetectionBits);
  static_assert(kMostSensorsOfAKind <= 1 << kSensorBits && kSensorKinds <= 1U << kKindBits);
  const std::uint64_t time = static_cast<std::uint64_t>(ToMicros(stamp)) >> kUnit_us_bits;
  const std::uint64_t which =
      static_cast<std::uint64_t>(sensor.kind) << kSensorBits | static_cast<unsigned>(sensor.index);
  return (time << (kKindBits + kSensorBits) | which) << kDetectionBits | index;
}

TrackTable::TrackTable(const TrackerConfig& config)
    : max_tracks_(static_cast<std::size_t>(config.max_tracks)),
      survival_per_s_(config.survival_per_s),
      settings_{config.motion, config.point_targets},
      rules_(config) {}

double TrackTable::Predict(Timestamp stamp) {
  faults_.clear();
  came_to_nothing_.clear();
  const double dt_s = tracks_.empty() ? 0.0 : std::max(0.0, ToSeconds(stamp - now_));
  now_ = stamp;
  const double survival = std::pow(survival_per_s_, dt_s);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    evidence_[i].filter.Predict(dt_s, settings_);
    tracks_[i].existence *= survival;
    if (!Show(i)) continue;
    if (!rules_.MayCoast(tracks_[i], evidence_[i], now_)) evidence_[i].is_ended = true;
  }
  RemoveEnded();
  return dt_s;
}

bool TrackTable::Show(std::size_t i) {
  LocalTrack& track = tracks_[i];
  evidence_[i].filter.Show(settings_, track);
  if (IsPossible(track)) return true;
  Fail(i);
  return false;
}

// Two messages of one sensor may bear one stamp. Tracks of other times come first in the table.
std::uint64_t TrackTable::FreeId(SensorKey sensor, std::size_t index) const {
  std::uint64_t id = PackId(now_, sensor, index);
  const std::uint64_t first = PackId(now_, {}, 0);
  const auto is_taken = [&] {
    for (auto other = tracks_.rbegin(); other != tracks_.rend() && other->id >= first; ++other) {
      if (other->id == id) return true;
    }
    return false;
  };
  while (is_taken()) ++id;
  return id;
}

bool TrackTable::Start(const TrackFilter& filter, SensorKey sensor, std::size_t index,
                       double existence) {
  if (index >= kMostDetections) return false;
  if (tracks_.size() >= max_tracks_) {
    AddFault(Reason::kTrackTableFull);
    return false;
  }
  LocalTrack track;
  track.id = FreeId(sensor, index);
  track.start = now_;
  track.is_point = settings_.point_targets;
  track.existence = std::max(existence, kMinBirth);
  filter.Show(settings_, track);
  TrackEvidence evidence;
  evidence.proven = track.existence;
  evidence.filter = filter;
  tracks_.push_back(track);
  evidence_.push_back(evidence);
  NoteHit(tracks_.size() - 1, sensor);
  return true;
}

void TrackTable::NoteHit(std::size_t i, SensorKey sensor, bool is_echo) {
  evidence_[i].last_hit = now_;
  evidence_[i].missed_looks = 0.0;
  if (!is_echo) evidence_[i].borne_out = now_;
  tracks_[i].support.Add(sensor, now_);
}

void TrackTable::NoteClass(std::size_t i, ObjectClass object_class, double score) {
  auto& votes = evidence_[i].class_votes;
  const auto named = static_cast<std::size_t>(object_class);
  if (named == 0 || named >= votes.size()) return;
  for (double& vote : votes) vote *= kVoteMemory;
  votes[named] += std::max(score, kLeastVote);
  ObjectClass& current = evidence_[i].named;
  if (votes[named] > kClearlyBetter * votes[static_cast<std::size_t>(current)]) {
    current = object_class;
  }
  const ObjectClass plausible = evidence_[i].height.Plausible(current);
  if (plausible == tracks_[i].object_class) return;
  tracks_[i].object_class = plausible;
  evidence_[i].filter.SetClass(plausible);
}

void TrackTable::Fail(std::size_t i) {
  AddFault(Reason::kTrackNumerics);
  evidence_[i].is_ended = true;
}

void TrackTable::Judge() {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (Show(i)) rules_.Judge(now_, tracks_[i], evidence_[i]);
  }
}

void TrackTable::EndStep() {
  EndUnlikely();
  RemoveEnded();
  // Births come in order of their index; only two sensors with one stamp can need more than this.
  for (std::size_t i = 1; i < tracks_.size(); ++i) {
    for (std::size_t k = i; k > 0 && tracks_[k].id < tracks_[k - 1].id; --k) {
      std::swap(tracks_[k], tracks_[k - 1]);
      std::swap(evidence_[k], evidence_[k - 1]);
    }
  }
}

// Of many tracks that are not listed the likeliest stay.
void TrackTable::EndUnlikely() {
  guesses_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const bool may_go = !tracks_[i].is_confirmed && !evidence_[i].is_certain;
    if (may_go && !evidence_[i].is_ended) guesses_.push_back(i);
  }
  if (guesses_.size() <= kMostGuesses) return;
  std::ranges::sort(guesses_, {},
                    [&](std::size_t i) { return std::pair(-tracks_[i].existence, tracks_[i].id); });
  for (std::size_t k = kMostGuesses; k < guesses_.size(); ++k) {
    evidence_[guesses_[k]].is_ended = true;
  }
  AddFault(Reason::kTrackTableFull);
}

void TrackTable::RemoveEnded() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (evidence_[i].is_ended) {
      const int cell = evidence_[i].clutter_cell;
      if (cell >= 0) came_to_nothing_.push_back({cell, tracks_[i].radar_hits()});
      continue;
    }
    if (kept != i) {
      tracks_[kept] = tracks_[i];
      evidence_[kept] = evidence_[i];
    }
    ++kept;
  }
  tracks_.resize(kept);
  evidence_.resize(kept);
}

double TrackTable::CrowdOf(std::size_t detections) const {
  const auto listed = std::ranges::count_if(tracks_, &LocalTrack::is_confirmed);
  return static_cast<double>(detections) - static_cast<double>(listed) -
         static_cast<double>(kMostNewcomers);
}

}  // namespace v2vouch
