// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/detectability.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {
namespace {

// Nothing is detected for certain: a miss must leave a little existence.
constexpr double kMostDetection = 0.999;
// A sensor's first frame comes long after any other.
constexpr double kNever_s = 1e9;
// What a detector draws of a vehicle that it sees half of: its centre is off by up to so much.
constexpr double kUnseenSigma_m = 1.0;

}  // namespace

void FrameDetectability::Ask(SensorKey sensor, const DetectabilityOf& detectability,
                             TrackTable& table) {
  Timestamp& last = last_frame_[SlotOf(sensor)];
  const double since_s = last == Timestamp{} ? kNever_s : ToSeconds(table.now() - last);
  last = table.now();
  const double share = miss_memory_s_ > 0.0 ? std::clamp(since_s / miss_memory_s_, 0.0, 1.0) : 1.0;
  detection_.resize(table.size());
  missing_.resize(table.size());
  missed_.resize(table.size());
  answers_.clear();
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto [track, evidence] = table[i];
    const Detectability answer = detectability(track);
    detection_[i] = std::clamp(answer.probability, 0.0, kMostDetection);
    track.visibility = answer.visibility;
    answers_.push_back(answer);
    missing_[i] = track.is_confirmed ? 1.0 - std::pow(1.0 - detection_[i], share) : detection_[i];
    if (sensor.kind == SensorKind::kRadar && !evidence.has_range) missing_[i] = 0.0;
    evidence.missed_looks += missing_[i];
    missed_[i] = 1.0 - track.existence * missing_[i];
  }
}

RadarMeasurement FrameDetectability::Given(std::size_t i, const TrackTable&,
                                           const RadarMeasurement& z) const {
  RadarMeasurement given = z;
  given.visible_share = answers_[i].visible_share;
  return given;
}

CameraMeasurement FrameDetectability::Given(std::size_t i, const TrackTable& table,
                                            const CameraMeasurement& z) const {
  CameraMeasurement given = z;
  // A point has no edges: half a box still tells it more than none.
  if (!table[i].evidence.filter.is_vehicle()) return given;
  given.left_is_cut |= answers_[i].left_is_covered;
  given.right_is_cut |= answers_[i].right_is_covered;
  return given;
}

BoxMeasurement FrameDetectability::Given(std::size_t i, const TrackTable&,
                                         const BoxMeasurement& z) const {
  BoxMeasurement given = z;
  given.visible_share = answers_[i].visible_share;
  const double unseen_m = kUnseenSigma_m * (1.0 - std::clamp(given.visible_share, 0.0, 1.0));
  given.position_covariance += unseen_m * unseen_m * Eigen::Matrix2d::Identity();
  return given;
}

}  // namespace v2vouch
