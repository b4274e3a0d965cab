// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/local/tracking/box_measurement.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

constexpr int kBoxSensor = 15;  // As poses.
constexpr std::size_t kMostFrameBoxes = 4096;

}  // namespace

void Tracker::PrepareBoxes(const BoxSensor& sensor, std::span<const BoxMeasurement> boxes) {
  const double sigmas = std::sqrt(gate_[2]);
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
  boxes = boxes.first(std::min(boxes.size(), kMostFrameBoxes));
  updates_.clear();
  pose_updates_.clear();
  costs_.clear();
  pairs_.clear();
  PrepareBoxes(sensor, boxes);
  AskDetectability(kBoxSensor, detectability);
  const double sigmas = std::sqrt(gate_[2]);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const TrackFilter& filter = hidden_[i].filter;
    double reach_m = sigmas * LargestSigma(filter.position_covariance());
    // A point is a reflection somewhere on a vehicle.
    if (!filter.is_vehicle()) reach_m += tracks_[i].extent.length_m;
    candidates_.ForEachNear(filter.position_O(), reach_m, [&](std::size_t j) {
      if (!candidates_[j].may_start) return;
      if (const auto likelihood = filter.Evaluate(boxes[j], settings_)) {
        AddPair(i, j, *likelihood, 0.0);
      }
    });
  }
  Associate(boxes.size());

  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (assigned_[i] < 0) continue;
    const auto j = static_cast<std::size_t>(assigned_[i]);
    candidates_[j].may_start = false;
    if (!hidden_[i].filter.Update(boxes[j])) {
      failures_.push_back(Reason::kTrackNumerics);
      hidden_[i].is_dead = true;
      continue;
    }
    Hit(i);
    ++hidden_[i].pose_hits;
    hidden_[i].last_pose = now_;
    pose_updates_.push_back({tracks_[i].id, j});
  }
  for (std::size_t j = 0; j < boxes.size(); ++j) {
    if (!candidates_[j].may_start) continue;
    const std::uint64_t id = PackPoseId(now_, static_cast<int>(j));
    const double existence = candidates_[j].birth_existence * (1.0 - marginals_.explained()[j]);
    if (!StartAs(id, TrackFilter::FromBox(boxes[j]), existence)) continue;
    hidden_.back().pose_hits = 1;
    hidden_.back().last_pose = now_;
    pose_updates_.push_back({id, j});
  }
  Conclude(since_update_s_);
}

}  // namespace v2vouch
