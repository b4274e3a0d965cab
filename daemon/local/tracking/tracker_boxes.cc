// SPDX-License-Identifier: Apache-2.0
// Frames of boxes: a configured source of objects, or a bench's.
#include <algorithm>
#include <cmath>

#include "daemon/local/tracking/tracker_whole.h"

namespace v2vouch {
namespace {

// Beyond this a score changes nothing any more.
constexpr double kMostLogOdds = 20.0;

// The score tells a vehicle from clutter before any track is asked.
void AddCandidates(const BoxSensor& sensor, std::span<const BoxMeasurement> boxes,
                   double birth_per_m2_s, TrackTable& table, Association& association) {
  const double sigmas = association.GateSigmas(WholeTraits<BoxMeasurement>::kGateRows);
  Candidates& candidates = association.candidates();
  for (const BoxMeasurement& z : boxes) {
    Candidate candidate;
    if (const auto fault = FaultOf(z)) {
      table.AddFault(*fault);
      candidate.p_O = Candidate::Nowhere();
      candidates.Add(candidate);
      continue;
    }
    const double clutter =
        sensor.clutter_per_m2 * std::exp(-std::clamp(z.log_odds, -kMostLogOdds, kMostLogOdds));
    candidate.birth_existence = BirthExistence(birth_per_m2_s * sensor.period_s, clutter);
    candidate.log_density = std::log(clutter / (1.0 - candidate.birth_existence));
    candidate.p_O << z.x_m, z.y_m;
    candidate.reach_m = sigmas * LargestSigma(z.position_covariance);
    candidate.may_start = true;
    candidates.Add(candidate);
  }
  candidates.Sort();
}

}  // namespace

void Tracker::UpdateBoxes(const BoxSensor& sensor, std::span<const BoxMeasurement> boxes,
                          const DetectabilityOf& detectability) {
  const WholeFrame frame{.sensor = {SensorKind::kObjects, 0}};
  boxes = boxes.first(std::min(boxes.size(), TrackTable::kMostDetections));
  Begin(frame.sensor, detectability);
  AddCandidates(sensor, boxes, config_.birth_per_m2_s, table_, association_);
  UpdateWhole(frame, boxes);
}

void Tracker::UpdateObjects(int source, const EgoState& ego, std::span<const BoxMeasurement> boxes,
                            const DetectabilityOf& detectability) {
  const ObjectSensorConfig& config = vehicle_->objects[static_cast<std::size_t>(source)];
  const WholeFrame frame{.sensor = {SensorKind::kObjects, source},
                         .origin_O = (ego.X_OB * Point<Body>{config.x_m, config.y_m}).vector(),
                         .most_newcomers = TrackTable::kMostNewcomers,
                         .is_bench = false};
  boxes = boxes.first(std::min(boxes.size(), TrackTable::kMostDetections));
  const double area_m2 = config.half_fov_rad * (config.max_range_m * config.max_range_m -
                                                config.min_range_m * config.min_range_m);
  const double clutter = std::max(config.clutter_per_frame, table_.CrowdOf(boxes.size()));
  Begin(frame.sensor, detectability);
  AddCandidates({config.period_s, clutter / std::max(area_m2, 1.0)}, boxes, config_.birth_per_m2_s,
                table_, association_);
  UpdateWhole(frame, boxes);
}

}  // namespace v2vouch
