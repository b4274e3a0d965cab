// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace v2vouch {
namespace {

// What so many pictures have named is a vehicle. Where a radar still sees it, pictures without it
// are a detector's bad second: each counts for this share of one.
constexpr int kKnownByPictures = 15;
constexpr double kStillReflects_s = 0.2;
constexpr double kSpellShare = 0.25;

}  // namespace

Tracker::Tracker(const TrackerConfig& config, const VehicleConfig& vehicle)
    : config_(config),
      vehicle_(std::make_shared<const VehicleConfig>(vehicle)),
      table_(config),
      association_(config),
      returns_(config.point_targets),
      clutter_(vehicle.radars.size()) {}

void Tracker::Predict(Timestamp stamp) {
  for (const TrackTable::Nothing& nothing : table_.came_to_nothing()) {
    clutter_.Count(nothing.clutter_cell, nothing.radar_hits);
  }
  since_frame_s_ += table_.Predict(stamp);
}

void Tracker::Begin(SensorKey sensor, const DetectabilityOf& detectability) {
  updates_.clear();
  pose_updates_.clear();
  association_.Begin(sensor, detectability, table_);
}

void Tracker::Prove(std::size_t i) {
  const auto [track, evidence] = table_[i];
  if (association_.GivenTo(i)) {
    evidence.proven = std::max(evidence.proven, track.existence);
    return;
  }
  double missing = association_.expected().missing(i);
  const bool still_reflects = ToSeconds(table_.now() - evidence.reflected) < kStillReflects_s;
  if (still_reflects && track.camera_hits() >= kKnownByPictures) {
    missing = 1.0 - std::pow(1.0 - missing, kSpellShare);
  }
  evidence.proven = ExistenceAfterMiss(evidence.proven, missing);
}

// The end of every frame: shows the new states, confirms, ends and puts in order.
void Tracker::Conclude() {
  roads_.FaceAlong(table_);
  table_.Judge();
  one_vehicle_.Apply(std::exchange(since_frame_s_, 0.0), table_);
  table_.EndStep();
}

void Tracker::ForgetUnpicturedSince(Timestamp since) {
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const auto [track, evidence] = table_[i];
    if (track.start < since) continue;
    if (track.camera_hits() + track.object_hits() == 0) evidence.is_ended = true;
  }
  table_.RemoveEnded();
  returns_.ForgetMoving();
}

}  // namespace v2vouch
