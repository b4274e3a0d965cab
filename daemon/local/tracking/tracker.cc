// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/tracker.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/chi_square.h"

namespace v2vouch {
namespace {

const double kLog2Pi = std::log(2.0 * kPi);
// For the choice of an assignment a young track counts at least this much, so that its second hit
// reaches it and does not start another track beside it. Existence itself uses the true value.
constexpr double kAssignmentExistence = 0.05;
// A track just outside of a sensor's view may still be seen by it.
constexpr double kMinDetection = 0.02;
constexpr double kSureExistence = 0.9999;
// Most that one frame adds to a listed track's odds of existence. What reflects once shows again
// and again (a wall's echo, a multipath ghost): a hit is no independent proof, and a track that is
// met in one frame of four must go down.
constexpr double kMostGain = 5.0;
// How long a hidden track is kept for each second it was known.
constexpr double kHoldPerKnown = 3.0;
constexpr double kLeastHold_s = 0.3;
constexpr double kCoastingSince_s = 0.5;
// What a vehicle was called is remembered for some twenty pictures: a name that was wrong for a
// while is overcome as fast.
constexpr double kVoteMemory = 0.95;

}  // namespace

std::uint64_t Tracker::PackId(Timestamp stamp, SensorKey sensor, std::size_t index) {
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

Tracker::Tracker(const TrackerConfig& config, const VehicleConfig& vehicle)
    : config_(config),
      vehicle_(std::make_shared<const VehicleConfig>(vehicle)),
      settings_{config.motion, config.point_targets} {
  for (int rows = 1; rows <= Linearized::kMaxRows; ++rows) {
    gate_[static_cast<std::size_t>(rows)] = ChiSquareQuantile(config.gate_probability, rows);
  }
}

void Tracker::Predict(Timestamp stamp) {
  failures_.clear();
  const double dt_s = tracks_.empty() ? 0.0 : std::max(0.0, ToSeconds(stamp - now_));
  now_ = stamp;
  since_update_s_ += dt_s;
  const double survival = std::pow(config_.survival_per_s, dt_s);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    Hidden& hidden = hidden_[i];
    LocalTrack& track = tracks_[i];
    hidden.filter.Predict(dt_s, settings_);
    hidden.filter.Show(settings_, track);
    track.existence *= survival;
    if (!track.state_O.mean.allFinite() || !track.state_O.covariance.allFinite()) {
      failures_.push_back(Reason::kTrackNumerics);
      hidden.is_dead = true;
      continue;
    }
    const double silent_s = ToSeconds(now_ - hidden.last_hit);
    // What was seen for a moment only is not waited for.
    const double known_s = ToSeconds(hidden.last_hit - track.start);
    // Boxes alone leave the velocity open.
    const bool has_velocity = track.radar_hits() + track.object_hits() > 0;
    const double hold_s =
        has_velocity ? std::min(config_.hidden_hold_s, kHoldPerKnown * known_s + kLeastHold_s)
                     : kLeastHold_s;
    if (track.visibility != Visibility::kVisible && silent_s > hold_s) {
      hidden.is_dead = true;
    }
    if (silent_s > kCoastingSince_s && !IsWorthListing(i)) hidden.is_dead = true;
  }
  RemoveDead();
}

void Tracker::AskDetectability(SensorKey sensor, const DetectabilityOf& detectability) {
  Timestamp& last = last_look_[SlotOf(sensor)];
  const double since_s = last == Timestamp{} ? 1e9 : ToSeconds(now_ - last);
  last = now_;
  const double share =
      config_.miss_memory_s > 0.0 ? std::clamp(since_s / config_.miss_memory_s, 0.0, 1.0) : 1.0;
  detection_.resize(tracks_.size());
  missing_.resize(tracks_.size());
  missed_.resize(tracks_.size());
  seen_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Detectability answer = detectability(tracks_[i]);
    detection_[i] = std::clamp(answer.probability, 0.0, 0.999);
    tracks_[i].visibility = answer.visibility;
    seen_.push_back(answer);
    missing_[i] =
        tracks_[i].is_confirmed ? 1.0 - std::pow(1.0 - detection_[i], share) : detection_[i];
    // A radar cannot miss what is only guessed to be there.
    if (sensor.kind == SensorKind::kRadar && !hidden_[i].has_range) missing_[i] = 0.0;
    missed_[i] = 1.0 - tracks_[i].existence * missing_[i];
  }
}

RadarMeasurement Tracker::Given(std::size_t track, const RadarMeasurement& z) const {
  RadarMeasurement given = z;
  given.visible_share = seen_[track].visible_share;
  return given;
}

CameraMeasurement Tracker::Given(std::size_t track, const CameraMeasurement& z) const {
  CameraMeasurement given = z;
  // A point has no edges: half a box still tells it more than none.
  if (!hidden_[track].filter.is_vehicle()) return given;
  given.left_is_cut |= seen_[track].left_is_covered;
  given.right_is_cut |= seen_[track].right_is_covered;
  return given;
}

// `log_cells`: how much larger the measurement's own space is than the one it was compared in.
void Tracker::AddPair(std::size_t track, std::size_t measurement, const Likelihood& likelihood,
                      double log_cells) {
  if (likelihood.distance_squared > gate_[static_cast<std::size_t>(likelihood.rows)]) return;
  const double log_likelihood =
      -0.5 * (likelihood.distance_squared + likelihood.log_det + likelihood.rows * kLog2Pi);
  const double detection = std::max(detection_[track], kMinDetection);
  const double log_ratio =
      log_likelihood + std::log(detection) - candidates_[measurement].log_density - log_cells;
  const double existence = tracks_[track].existence;
  const double counted = std::max(existence, kAssignmentExistence);
  // Cost against leaving the track alone and calling the measurement clutter or a newcomer.
  const double cost = -(log_ratio + std::log(counted) -
                        std::log(1.0 - counted * std::max(missing_[track], kMinDetection)));
  const int row = static_cast<int>(track);
  const int column = static_cast<int>(measurement);
  costs_.push_back({row, column, cost});
  pairs_.push_back({row, column, existence * std::exp(std::min(log_ratio, 200.0))});
}

void Tracker::Associate(std::size_t measurements, Proof proof) {
  lone_.assign(tracks_.size(), 0.0);
  const auto best = solver_.Solve(costs_, tracks_.size(), measurements, lone_);
  assigned_.assign(best.begin(), best.end());
  marginals_.Compute(pairs_, missed_, assigned_, measurements);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const double seen = marginals_.detected()[i];
    const double unseen = ExistenceAfterMiss(tracks_[i].existence, missing_[i]);
    double next = std::min(seen + (1.0 - seen) * unseen, kSureExistence);
    if (proof == Proof::kRepeated && tracks_[i].is_confirmed) {
      const double odds = kMostGain * tracks_[i].existence / (1.0 - tracks_[i].existence);
      next = std::min(next, odds / (1.0 + odds));
    }
    tracks_[i].existence = next;
  }
}

// What a frame holds beyond the vehicles that are listed and a crowd of new ones is clutter,
// however little the sensor promised: interference would else be published as vehicles everywhere.
double Tracker::Crowd(std::size_t detections) const {
  const auto listed = std::ranges::count_if(tracks_, &LocalTrack::is_confirmed);
  return static_cast<double>(detections) - static_cast<double>(listed) -
         static_cast<double>(kMostNewcomers);
}

void Tracker::Hit(std::size_t track, SensorKey sensor, bool is_echo) {
  hidden_[track].last_hit = now_;
  if (!is_echo) hidden_[track].borne_out = now_;
  tracks_[track].support.Add(sensor, now_);
}

void Tracker::Vote(std::size_t track, ObjectClass object_class, double score) {
  const auto named = static_cast<std::size_t>(object_class);
  Hidden& hidden = hidden_[track];
  if (named == 0 || named >= hidden.class_votes.size()) return;
  for (double& votes : hidden.class_votes) votes *= kVoteMemory;
  hidden.class_votes[named] += std::max(score, 0.05);
  const auto current = static_cast<std::size_t>(tracks_[track].object_class);
  // A name changes only for one that is clearly better supported.
  if (named != current && hidden.class_votes[named] > 1.5 * hidden.class_votes[current]) {
    tracks_[track].object_class = object_class;
    hidden.filter.SetClass(object_class);
  }
}

bool Tracker::Start(const TrackFilter& filter, SensorKey sensor, std::size_t index,
                    double existence) {
  if (index >= kMostDetections) return false;
  std::uint64_t id = PackId(now_, sensor, index);
  // Two messages of one sensor may bear one stamp. Tracks of other times come first in the table.
  const std::uint64_t first = PackId(now_, {}, 0);
  const auto is_taken = [&] {
    for (auto other = tracks_.rbegin(); other != tracks_.rend() && other->id >= first; ++other) {
      if (other->id == id) return true;
    }
    return false;
  };
  while (is_taken()) ++id;
  if (tracks_.size() >= static_cast<std::size_t>(config_.max_tracks)) {
    failures_.push_back(Reason::kTrackTableFull);
    return false;
  }
  LocalTrack track;
  track.id = id;
  track.start = now_;
  track.is_point = settings_.point_targets;
  track.existence = std::max(existence, kMinBirth);
  filter.Show(settings_, track);
  Hidden hidden;
  hidden.proven = track.existence;
  hidden.filter = filter;
  hidden.last_hit = now_;
  tracks_.push_back(track);
  hidden_.push_back(hidden);
  Hit(tracks_.size() - 1, sensor);
  return true;
}

}  // namespace v2vouch
