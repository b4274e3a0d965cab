// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/local/tracking/tracker_whole.h"

namespace v2vouch {
namespace {

// What a detector draws of a vehicle that it sees half of: its centre is off by up to so much.
constexpr double kUnseenSigma_m = 1.0;

}  // namespace

BoxMeasurement Tracker::Given(std::size_t track, const BoxMeasurement& z) const {
  BoxMeasurement given = z;
  given.visible_share = seen_[track].visible_share;
  const double unseen_m = kUnseenSigma_m * (1.0 - std::clamp(given.visible_share, 0.0, 1.0));
  given.position_covariance += unseen_m * unseen_m * Eigen::Matrix2d::Identity();
  return given;
}

void Tracker::PrepareBoxes(const BoxSensor& sensor, std::span<const BoxMeasurement> boxes) {
  const double sigmas = std::sqrt(gate_[WholeTraits<BoxMeasurement>::kGateRows]);
  candidates_.Clear();
  for (const BoxMeasurement& z : boxes) {
    Candidate candidate;
    if (const auto fault = FaultOf(z)) {
      failures_.push_back(*fault);
      candidate.p_O.setConstant(std::numeric_limits<double>::max() / 4.0);
      candidates_.Add(candidate);
      continue;
    }
    // The score tells a vehicle from clutter before any track is asked.
    const double clutter = sensor.clutter_per_m2 * std::exp(-std::clamp(z.log_odds, -20.0, 20.0));
    candidate.birth_existence = BirthExistence(config_.birth_per_m2_s * sensor.period_s, clutter);
    candidate.log_density = std::log(clutter / (1.0 - candidate.birth_existence));
    candidate.p_O << z.x_m, z.y_m;
    candidate.reach_m = sigmas * LargestSigma(z.position_covariance);
    candidate.may_start = true;
    candidates_.Add(candidate);
  }
  candidates_.Sort();
}

void Tracker::UpdateBoxes(const BoxSensor& sensor, std::span<const BoxMeasurement> boxes,
                          const DetectabilityOf& detectability) {
  boxes = boxes.first(std::min(boxes.size(), kMostDetections));
  PrepareBoxes(sensor, boxes);
  UpdateWhole({.sensor = {SensorKind::kObjects, 0}}, boxes, detectability);
}

void Tracker::UpdateObjects(int source, const EgoState& ego, std::span<const BoxMeasurement> boxes,
                            const DetectabilityOf& detectability) {
  const ObjectSensorConfig& config = vehicle_->objects[static_cast<std::size_t>(source)];
  boxes = boxes.first(std::min(boxes.size(), kMostDetections));
  const double area_m2 = config.half_fov_rad * (config.max_range_m * config.max_range_m -
                                                config.min_range_m * config.min_range_m);
  const double clutter = std::max(config.clutter_per_frame, Crowd(boxes.size()));
  PrepareBoxes({config.period_s, clutter / std::max(area_m2, 1.0)}, boxes);
  UpdateWhole({.sensor = {SensorKind::kObjects, source},
               .origin_O = (ego.X_OB * Point<Body>{config.x_m, config.y_m}).vector(),
               .most_newcomers = kMostNewcomers,
               .is_bench = false},
              boxes, detectability);
}

}  // namespace v2vouch
