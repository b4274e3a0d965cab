// SPDX-License-Identifier: Apache-2.0
#include "sim/bench/box_bench.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/measurement.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch::bench {
namespace {

constexpr std::int64_t kEpoch_us = 1'700'000'000'000'000;
constexpr double kFramePeriod_s = 0.1;
// KITTI's left colour camera, to within what the recordings differ in.
constexpr double kFocal_px = 721.5;
constexpr double kCenterX_px = 609.6;
constexpr double kCenterY_px = 172.9;
constexpr double kWidth_px = 1242.0;
constexpr double kHeight_px = 375.0;
constexpr double kNearest_m = 0.5;
// A vehicle of which nearer ones cover more than this is hidden.
constexpr double kHiddenShare = 0.7;
constexpr double kHiddenDetection = 0.3;
constexpr double kUpGain = 0.5;

// What the bench remembers of a track beside the tracker.
struct Record {
  double bottom_m = 0.0;
  double height_m = 0.0;
  double score_sum = 0.0;
  int hits = 0;
  double first_hit_s = 0.0;
  double last_hit_s = 0.0;
  bool is_shown = false;
  PixelBox pixels;
};

BoxMeasurement ToMeasurement(const DetectedBox& found, const Eigen::Isometry2d& X_OS,
                             const BoxSettings& settings) {
  const Box3d& box = found.box;
  const Eigen::Vector2d p_S(box.x_m, box.y_m);
  const Eigen::Vector2d p_O = X_OS * p_S;
  const double sigma = settings.position_sigma_m + settings.position_sigma_per_m * p_S.norm();
  BoxMeasurement z;
  z.x_m = p_O.x();
  z.y_m = p_O.y();
  z.yaw_rad = WrapAngle(box.yaw_rad + Eigen::Rotation2Dd(X_OS.linear()).angle());
  z.length_m = box.length_m;
  z.width_m = box.width_m;
  z.position_covariance = sigma * sigma * Eigen::Matrix2d::Identity();
  z.yaw_sigma_rad = settings.yaw_sigma_rad;
  z.length_sigma_m = settings.length_sigma_m;
  z.width_sigma_m = settings.width_sigma_m;
  z.log_odds = settings.score_scale * (found.score - settings.score_offset);
  return z;
}

// The picture's part of a box; no height: it is not in the picture.
PixelBox Project(const Box3d& box) {
  constexpr double kFar = std::numeric_limits<double>::max();
  PixelBox out{kFar, kFar, -kFar, -kFar};
  const Eigen::Rotation2D<double> R(box.yaw_rad);
  for (const double along : {-0.5, 0.5}) {
    for (const double across : {-0.5, 0.5}) {
      const Eigen::Vector2d p = Eigen::Vector2d(box.x_m, box.y_m) +
                                R * Eigen::Vector2d(along * box.length_m, across * box.width_m);
      const double ahead = std::max(p.x(), kNearest_m);
      for (const double up : {box.bottom_m, box.bottom_m + box.height_m}) {
        const double u = kCenterX_px - kFocal_px * p.y() / ahead;
        const double v = kCenterY_px - kFocal_px * up / ahead;
        out = {std::min(out.left, u), std::min(out.top, v), std::max(out.right, u),
               std::max(out.bottom, v)};
      }
    }
  }
  out = {std::clamp(out.left, 0.0, kWidth_px), std::clamp(out.top, 0.0, kHeight_px),
         std::clamp(out.right, 0.0, kWidth_px), std::clamp(out.bottom, 0.0, kHeight_px)};
  return out;
}

bool IsInPicture(const Box3d& box) {
  if (box.x_m < kNearest_m) return false;
  const double u = kCenterX_px - kFocal_px * box.y_m / box.x_m;
  return u > 0.0 && u < kWidth_px;
}

Box3d InSensor(const LocalTrack& track, const Record* record, const Eigen::Isometry2d& X_OS) {
  const Eigen::Vector2d p_S = X_OS.inverse() * track.state_O.mean.head<2>();
  Box3d box{
      .x_m = p_S.x(),
      .y_m = p_S.y(),
      .yaw_rad = WrapAngle(track.state_O.mean[kYaw] - Eigen::Rotation2Dd(X_OS.linear()).angle()),
      .length_m = track.extent.length_m,
      .width_m = track.extent.width_m};
  if (record != nullptr) {
    box.bottom_m = record->bottom_m;
    box.height_m = record->height_m;
  }
  return box;
}

class SequenceTracker {
 public:
  explicit SequenceTracker(const BoxSettings& settings)
      : settings_(settings), tracker_(ConfigOf(settings), VehicleConfig{}) {}

  // One frame; @return its rows.
  std::vector<TrackedBox> Step(const BoxSequence::Frame& frame, double time_s,
                               const Stopwatch& watch, std::vector<double>& step_ms) {
    boxes_.clear();
    for (const DetectedBox& found : frame.detections) {
      boxes_.push_back(ToMeasurement(found, frame.X_OS, settings_));
    }
    const double begin_s = watch ? watch() : 0.0;
    tracker_.Predict(FromMicros(kEpoch_us) + FromSeconds(time_s));
    FindBearings(frame.X_OS);
    const BoxSensor sensor{kFramePeriod_s, settings_.clutter_per_m2};
    tracker_.UpdateBoxes(sensor, boxes_, [&](const LocalTrack& t) { return Look(t, frame.X_OS); });
    step_ms.push_back(watch ? 1e3 * (watch() - begin_s) : 0.0);
    for (const PoseUpdate& update : tracker_.pose_updates()) {
      Note(records_[update.track_id], frame.detections[update.pose], time_s);
    }
    return Rows(frame.X_OS, time_s);
  }

 private:
  struct Bearings {
    std::uint64_t id = 0;
    double range_m = 0.0;
    double from_rad = 0.0;
    double to_rad = 0.0;
  };

  static TrackerConfig ConfigOf(const BoxSettings& settings) {
    TrackerConfig config;
    config.point_targets = true;  // A box is of the whole vehicle: no model of reflections.
    config.gate_probability = settings.gate_probability;
    config.motion.position_psd = settings.drift_psd;
    config.max_tracks = 4096;
    return config;
  }

  static Bearings BearingsOf(const LocalTrack& track, const Eigen::Isometry2d& X_OS) {
    const Box3d box = InSensor(track, nullptr, X_OS);
    const Eigen::Rotation2D<double> R(box.yaw_rad);
    Bearings out{track.id, std::hypot(box.x_m, box.y_m), kPi, -kPi};
    for (const double along : {-0.5, 0.5}) {
      for (const double across : {-0.5, 0.5}) {
        const Eigen::Vector2d p = Eigen::Vector2d(box.x_m, box.y_m) +
                                  R * Eigen::Vector2d(along * box.length_m, across * box.width_m);
        const double bearing = std::atan2(p.y(), p.x());
        out.from_rad = std::min(out.from_rad, bearing);
        out.to_rad = std::max(out.to_rad, bearing);
      }
    }
    return out;
  }

  void FindBearings(const Eigen::Isometry2d& X_OS) {
    bearings_.clear();
    for (const LocalTrack& track : tracker_.tracks()) {
      if (track.existence > 0.5) bearings_.push_back(BearingsOf(track, X_OS));
    }
  }

  // Whether the detector ought to see it: in the picture, and not behind another.
  [[nodiscard]] Detectability Look(const LocalTrack& track, const Eigen::Isometry2d& X_OS) const {
    Detectability answer{.probability = settings_.detection_probability};
    if (!IsInPicture(InSensor(track, nullptr, X_OS))) {
      answer.probability = 0.0;
      answer.visibility = Visibility::kOutOfView;
      return answer;
    }
    const Bearings own = BearingsOf(track, X_OS);
    double covered_rad = 0.0;
    for (const Bearings& other : bearings_) {
      if (other.id == track.id || other.range_m > own.range_m - 1.0) continue;
      const double both =
          std::min(own.to_rad, other.to_rad) - std::max(own.from_rad, other.from_rad);
      covered_rad += std::max(both, 0.0);
    }
    if (covered_rad > kHiddenShare * (own.to_rad - own.from_rad)) {
      answer.probability = std::min(answer.probability, kHiddenDetection);
      answer.visibility = Visibility::kHidden;
    }
    return answer;
  }

  void Note(Record& record, const DetectedBox& found, double time_s) const {
    const double gain = record.hits == 0 ? 1.0 : kUpGain;
    record.bottom_m += gain * (found.box.bottom_m - record.bottom_m);
    record.height_m += gain * (found.box.height_m - record.height_m);
    record.score_sum += found.score;
    if (record.hits++ == 0) record.first_hit_s = time_s;
    record.is_shown = record.is_shown || record.hits >= settings_.show_hits ||
                      found.score >= settings_.show_score;
    record.last_hit_s = time_s;
    record.pixels = found.pixels;
  }

  [[nodiscard]] std::vector<TrackedBox> Rows(const Eigen::Isometry2d& X_OS, double time_s) const {
    std::vector<TrackedBox> rows;
    for (const LocalTrack& track : tracker_.tracks()) {
      const auto found = records_.find(track.id);
      if (found == records_.end()) continue;
      const Record& record = found->second;
      if (!record.is_shown) continue;
      const double silent_s = time_s - record.last_hit_s;
      const bool is_hit = silent_s < 0.5 * kFramePeriod_s;
      TrackedBox row;
      row.id = track.id;
      row.box = InSensor(track, &record, X_OS);
      row.pixels = is_hit ? record.pixels : Project(row.box);
      row.score = (record.score_sum + settings_.doubt_hits * settings_.doubt_score) /
                  (record.hits + settings_.doubt_hits);
      if (!is_hit) {
        const double known_s = record.last_hit_s - record.first_hit_s;
        const double hold_s =
            std::min(settings_.coast_s, settings_.coast_share * known_s + settings_.coast_least_s);
        if (silent_s > hold_s || !IsInPicture(row.box)) continue;
        row.score -= settings_.coast_score;
      }
      const Eigen::Matrix2d R = X_OS.linear().transpose();
      row.covariance = R * track.state_O.covariance.topLeftCorner<2, 2>() * R.transpose();
      rows.push_back(row);
    }
    return rows;
  }

  BoxSettings settings_;
  Tracker tracker_;
  std::map<std::uint64_t, Record> records_;
  std::vector<BoxMeasurement> boxes_;
  std::vector<Bearings> bearings_;
};

}  // namespace

double BoxRun::ms_mean() const {
  return step_ms.empty() ? NAN
                         : std::accumulate(step_ms.begin(), step_ms.end(), 0.0) /
                               static_cast<double>(step_ms.size());
}

BoxRun TrackBoxes(const std::vector<BoxSequence>& sequences, const BoxSettings& settings,
                  const Stopwatch& watch) {
  BoxRun run;
  for (const BoxSequence& sequence : sequences) {
    SequenceTracker tracker(settings);
    EvaluatedSequence evaluated;
    double time_s = 0.0;
    for (const BoxSequence::Frame& frame : sequence.frames) {
      EvaluatedFrame answer{frame.truth, frame.regions, {}};
      answer.tracked = tracker.Step(frame, time_s, watch, run.step_ms);
      evaluated.push_back(std::move(answer));
      time_s += kFramePeriod_s;
    }
    run.sequences.push_back(std::move(evaluated));
  }
  return run;
}

}  // namespace v2vouch::bench
