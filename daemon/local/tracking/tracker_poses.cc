// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

constexpr int kPoseSensor = 15;
constexpr std::size_t kMaxPoses = 4096;

}  // namespace

std::uint64_t Tracker::PackPoseId(Timestamp stamp, int index) {
  const auto high = static_cast<std::uint64_t>(index) >> 8 & 15U;
  return ((static_cast<std::uint64_t>(ToMicros(stamp)) & ~std::uint64_t{15}) | high) << 12 |
         static_cast<std::uint64_t>(kPoseSensor) << 8 | (static_cast<std::uint64_t>(index) & 255U);
}

// One frame that reported both: two boxes are two vehicles, however close they stand.
bool Tracker::SeenAsTwo(std::size_t a, std::size_t b) const {
  return hidden_[a].pose_hits > 0 && hidden_[b].pose_hits > 0 &&
         hidden_[a].last_pose == hidden_[b].last_pose;
}

void Tracker::PreparePoses(const PoseSensor& sensor, std::span<const PoseMeasurement> poses) {
  const double birth_existence =
      BirthExistence(config_.birth_per_m2_s * sensor.period_s, sensor.clutter_per_m2);
  const double cells = sensor.speed_span_mps * sensor.yaw_span_rad * sensor.yaw_rate_span_radps;
  const double log_density = std::log(sensor.clutter_per_m2 / cells / (1.0 - birth_existence));
  const double sigmas = std::sqrt(gate_[LinearizedPose::kRows]);
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
  poses = poses.first(std::min(poses.size(), kMaxPoses));
  updates_.clear();
  pose_updates_.clear();
  costs_.clear();
  pairs_.clear();
  PreparePoses(sensor, poses);
  AskDetectability(kPoseSensor, detectability);
  const double sigmas = std::sqrt(gate_[LinearizedPose::kRows]);
  // A point is compared without the yaw rate and by velocity, where clutter fills a disc (or as
  // much of it as its directions do).
  const double log_point_cells = std::log(8.0 * sensor.yaw_rate_span_radps / sensor.speed_span_mps);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const TrackFilter& filter = hidden_[i].filter;
    double reach_m = sigmas * LargestSigma(filter.position_covariance());
    // A point is a reflection somewhere on a vehicle.
    if (!filter.knows_direction()) reach_m += tracks_[i].extent.length_m;
    candidates_.ForEachNear(filter.position_O(), reach_m, [&](std::size_t j) {
      if (!candidates_[j].may_start) return;
      if (const auto likelihood = filter.Evaluate(poses[j], settings_)) {
        AddPair(i, j, *likelihood, filter.knows_direction() ? 0.0 : log_point_cells);
      }
    });
  }
  Associate(poses.size());

  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (assigned_[i] < 0) continue;
    const auto j = static_cast<std::size_t>(assigned_[i]);
    candidates_[j].may_start = false;
    if (!hidden_[i].filter.Update(poses[j])) {
      failures_.push_back(Reason::kTrackNumerics);
      hidden_[i].is_dead = true;
      continue;
    }
    Hit(i);
    ++hidden_[i].pose_hits;
    hidden_[i].last_pose = now_;
    pose_updates_.push_back({tracks_[i].id, j});
  }
  for (std::size_t j = 0; j < poses.size(); ++j) {
    if (!candidates_[j].may_start) continue;
    const std::uint64_t id = PackPoseId(now_, static_cast<int>(j));
    const double existence = candidates_[j].birth_existence * (1.0 - marginals_.explained()[j]);
    if (!StartAs(id, TrackFilter::FromPose(poses[j]), existence)) continue;
    hidden_.back().pose_hits = 1;
    hidden_.back().last_pose = now_;
    pose_updates_.push_back({id, j});
  }
  Conclude(since_update_s_);
}

}  // namespace v2vouch
