// SPDX-License-Identifier: Apache-2.0
// Frames of whole poses: a simulation's or a bench's.
#include <algorithm>
#include <cmath>

#include "daemon/local/tracking/tracker_whole.h"

namespace v2vouch {
namespace {

void AddCandidates(const PoseSensor& sensor, std::span<const PoseMeasurement> poses,
                   double birth_per_m2_s, TrackTable& table, Association& association) {
  const double birth_existence =
      BirthExistence(birth_per_m2_s * sensor.period_s, sensor.clutter_per_m2);
  const double cells = sensor.speed_span_mps * sensor.yaw_span_rad * sensor.yaw_rate_span_radps;
  const double log_density = std::log(sensor.clutter_per_m2 / cells / (1.0 - birth_existence));
  const double sigmas = association.GateSigmas(WholeTraits<PoseMeasurement>::kGateRows);
  Candidates& candidates = association.candidates();
  for (const PoseMeasurement& z : poses) {
    Candidate candidate;
    candidate.log_density = log_density;
    candidate.birth_existence = birth_existence;
    if (const auto fault = FaultOf(z)) {
      table.AddFault(*fault);
      candidate.p_O = Candidate::Nowhere();
    } else {
      candidate.p_O << z.x_m, z.y_m;
      candidate.reach_m = sigmas * LargestSigma(z.covariance.topLeftCorner<2, 2>());
      candidate.may_start = true;
    }
    candidates.Add(candidate);
  }
  candidates.Sort();
}

}  // namespace

void Tracker::UpdatePoses(const PoseSensor& sensor, std::span<const PoseMeasurement> poses,
                          const DetectabilityOf& detectability) {
  // A point is compared without the yaw rate and by velocity, where clutter fills a disc (or as
  // much of it as its directions do).
  const WholeFrame frame{
      .sensor = {SensorKind::kObjects, 0},
      .log_point_cells = std::log(8.0 * sensor.yaw_rate_span_radps / sensor.speed_span_mps)};
  poses = poses.first(std::min(poses.size(), TrackTable::kMostDetections));
  Begin(frame.sensor, detectability);
  AddCandidates(sensor, poses, config_.birth_per_m2_s, table_, association_);
  UpdateWhole(frame, poses);
}

}  // namespace v2vouch
