// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/tracker.h"

#include <algorithm>
#include <utility>

namespace v2vouch {

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
  evidence.proven = association_.GivenTo(i)
                        ? std::max(evidence.proven, track.existence)
                        : ExistenceAfterMiss(evidence.proven, association_.expected().missing(i));
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
