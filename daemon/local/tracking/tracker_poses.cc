// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/local/tracking/tracker_whole.h"

namespace v2vouch {

// One frame that reported both: two boxes are two vehicles, however close they stand.
bool Tracker::SeenAsTwo(std::size_t a, std::size_t b) const {
  return tracks_[a].support.SharesFrame(tracks_[b].support, SensorKind::kObjects);
}

void Tracker::PreparePoses(const PoseSensor& sensor, std::span<const PoseMeasurement> poses) {
  const double birth_existence =
      BirthExistence(config_.birth_per_m2_s * sensor.period_s, sensor.clutter_per_m2);
  const double cells = sensor.speed_span_mps * sensor.yaw_span_rad * sensor.yaw_rate_span_radps;
  const double log_density = std::log(sensor.clutter_per_m2 / cells / (1.0 - birth_existence));
  const double sigmas = std::sqrt(gate_[WholeTraits<PoseMeasurement>::kGateRows]);
  candidates_.Clear();
  for (const PoseMeasurement& z : poses) {
    Candidate candidate;
    candidate.log_density = log_density;
    candidate.birth_existence = birth_existence;
    if (const auto fault = FaultOf(z)) {
      failures_.push_back(*fault);
      candidate.p_O.setConstant(std::numeric_limits<double>::max() / 4.0);
    } else {
      candidate.p_O << z.x_m, z.y_m;
      candidate.reach_m = sigmas * LargestSigma(z.covariance.topLeftCorner<2, 2>());
      candidate.may_start = true;
    }
    candidates_.Add(candidate);
  }
  candidates_.Sort();
}

void Tracker::UpdatePoses(const PoseSensor& sensor, std::span<const PoseMeasurement> poses,
                          const DetectabilityOf& detectability) {
  poses = poses.first(std::min(poses.size(), kMostDetections));
  PreparePoses(sensor, poses);
  // A point is compared without the yaw rate and by velocity, where clutter fills a disc (or as
  // much of it as its directions do).
  UpdateWhole(
      {.sensor = {SensorKind::kObjects, 0},
       .log_point_cells = std::log(8.0 * sensor.yaw_rate_span_radps / sensor.speed_span_mps)},
      poses, detectability);
}

}  // namespace v2vouch
