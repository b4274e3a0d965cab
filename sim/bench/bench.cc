// SPDX-License-Identifier: Apache-2.0
#include "sim/bench/bench.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/measurement.h"
#include "daemon/local/tracking/tracker.h"
#include "sim/metrics/gospa.h"

namespace v2vouch::bench {
namespace {

// Few or aligned detections span nothing: a road of this area at least.
constexpr double kSmallestArea_m2 = 1000.0;
constexpr double kSmallestYawSpan_rad = 0.1;
constexpr double kSmallestSpeedSpan_mps = 1.0;
constexpr double kSmallestYawRateSpan_radps = 0.01;
constexpr std::int64_t kEpoch_us = 1'700'000'000'000'000;

// Width of the uniform distribution of this variance, at least `smallest`.
double Span(const std::vector<VehiclePose>& poses, double VehiclePose::*value, double smallest) {
  double sum = 0.0, squares = 0.0;
  for (const VehiclePose& p : poses) sum += p.*value;
  const double n = static_cast<double>(std::max<std::size_t>(poses.size(), 1));
  for (const VehiclePose& p : poses) squares += std::pow(p.*value - sum / n, 2);
  return std::max(std::sqrt(12.0 * squares / n), smallest);
}

// Width of the directions' distribution about one axis, both ways taken together, from the mean
// resultant of twice the angle: R = exp(-2 sigma^2) for a wrapped normal distribution.
double YawSpan(const std::vector<VehiclePose>& poses) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const VehiclePose& p : poses) {
    sum += Eigen::Vector2d(std::cos(2.0 * p.yaw_rad), std::sin(2.0 * p.yaw_rad));
  }
  const double n = static_cast<double>(std::max<std::size_t>(poses.size(), 1));
  const double resultant = std::clamp(sum.norm() / n, 1e-9, 1.0);
  const double sigma = std::sqrt(-0.5 * std::log(resultant));
  return std::clamp(2.0 * std::sqrt(12.0) * sigma, kSmallestYawSpan_rad, 2.0 * kPi);
}

double SpannedArea(const std::vector<VehiclePose>& poses) {
  if (poses.size() < 3) return kSmallestArea_m2;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const VehiclePose& p : poses) mean += Eigen::Vector2d(p.x_m, p.y_m);
  mean /= static_cast<double>(poses.size());
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const VehiclePose& p : poses) {
    const Eigen::Vector2d d = Eigen::Vector2d(p.x_m, p.y_m) - mean;
    covariance += d * d.transpose();
  }
  covariance /= static_cast<double>(poses.size());
  return std::max(12.0 * std::sqrt(std::max(covariance.determinant(), 0.0)), kSmallestArea_m2);
}

void ToMeasurements(const std::vector<VehiclePose>& poses, const PoseNoise& noise,
                    std::vector<PoseMeasurement>& out) {
  Eigen::Matrix<double, 5, 1> sigma;
  sigma << noise.position_m, noise.position_m, noise.yaw_rad, noise.speed_mps, noise.yaw_rate_radps;
  out.clear();
  for (const VehiclePose& p : poses) {
    PoseMeasurement z{.x_m = p.x_m,
                      .y_m = p.y_m,
                      .yaw_rad = p.yaw_rad,
                      .speed_mps = p.speed_mps,
                      .yaw_rate_radps = p.yaw_rate_radps};
    z.covariance = sigma.cwiseAbs2().asDiagonal();
    out.push_back(z);
  }
}

// Judges confirmed tracks frame by frame.
class Judge {
 public:
  explicit Judge(const BenchSettings& settings)
      : settings_(settings), gospa_({.cutoff_m = settings.cutoff_m, .order = 2.0, .alpha = 2.0}) {}

  void Look(const Frame& frame, std::span<const LocalTrack> tracks, BenchFigures& figures) {
    truths_.clear();
    estimates_.clear();
    ids_.clear();
    for (const VehiclePose& p : frame.truth) truths_.emplace_back(p.x_m, p.y_m);
    for (const LocalTrack& track : tracks) {
      if (!track.is_confirmed) continue;
      estimates_.emplace_back(track.state_O.mean.head<2>());
      ids_.push_back(track.id);
    }
    const evaluation::GospaResult& result = gospa_.FromPoints(truths_, estimates_);
    ++figures.frames;
    figures.truths += static_cast<std::int64_t>(truths_.size());
    figures.gospa_sum += result.gospa;
    figures.assigned += result.num_assigned;
    figures.missed += result.num_missed;
    figures.false_states += result.num_false;
    figures.square_error_m2 += result.localisation_pow;
    is_used_.assign(ids_.size(), false);
    for (std::size_t i = 0; i < truths_.size(); ++i) {
      if (result.assignment[i] < 0) continue;
      const auto j = static_cast<std::size_t>(result.assignment[i]);
      is_used_[j] = true;
      const auto [held, is_first] = holder_.try_emplace(frame.truth[i].id, ids_[j]);
      if (!is_first && held->second != ids_[j]) ++figures.switches;
      held->second = ids_[j];
    }
    for (std::size_t j = 0; j < ids_.size(); ++j) {
      if (!is_used_[j]) false_ids_.insert(ids_[j]);
    }
    figures.false_tracks = static_cast<int>(false_ids_.size());
  }

 private:
  BenchSettings settings_;
  evaluation::Gospa gospa_;
  std::vector<Eigen::Vector2d> truths_, estimates_;
  std::vector<std::uint64_t> ids_;
  std::vector<bool> is_used_;
  std::map<int, std::uint64_t> holder_;  // Last track that held a truth.
  std::set<std::uint64_t> false_ids_;
};

Snapshot Take(const Tracker& tracker) {
  std::map<std::uint64_t, int> given;
  for (const PoseUpdate& update : tracker.pose_updates()) {
    given[update.track_id] = static_cast<int>(update.pose);
  }
  Snapshot snapshot;
  for (const LocalTrack& track : tracker.tracks()) {
    if (!track.is_confirmed) continue;
    const auto found = given.find(track.id);
    snapshot.ids.push_back(track.id);
    snapshot.poses.push_back(found == given.end() ? -1 : found->second);
  }
  return snapshot;
}

}  // namespace

double BenchFigures::gospa_mean() const { return frames > 0 ? gospa_sum / frames : NAN; }

double BenchFigures::rmse_m() const {
  return assigned > 0 ? std::sqrt(square_error_m2 / static_cast<double>(assigned)) : NAN;
}

double BenchFigures::ms_mean() const {
  double sum = 0.0;
  for (const double ms : step_ms) sum += ms;
  return step_ms.empty() ? NAN : sum / static_cast<double>(step_ms.size());
}

double BenchFigures::ms_quantile(double share) const {
  if (step_ms.empty()) return NAN;
  std::vector<double> sorted = step_ms;
  std::sort(sorted.begin(), sorted.end());
  const double place = std::ceil(share * static_cast<double>(sorted.size())) - 1.0;
  return sorted[static_cast<std::size_t>(
      std::clamp(place, 0.0, static_cast<double>(sorted.size() - 1)))];
}

void BenchFigures::Add(const BenchFigures& other) {
  frames += other.frames;
  truths += other.truths;
  detections += other.detections;
  gospa_sum += other.gospa_sum;
  square_error_m2 += other.square_error_m2;
  assigned += other.assigned;
  missed += other.missed;
  false_states += other.false_states;
  false_tracks += other.false_tracks;
  switches += other.switches;
  step_ms.insert(step_ms.end(), other.step_ms.begin(), other.step_ms.end());
}

BenchFigures RunBench(const Recording& recording, const BenchSettings& settings,
                      const Stopwatch& watch, std::vector<Snapshot>* snapshots) {
  TrackerConfig config;
  config.point_targets = true;
  config.confirm_existence = settings.confirm_existence;
  config.gate_probability = settings.gate_probability;
  config.survival_per_s = 0.9999;  // The sensor sees the whole road: hardly anybody leaves it.
  config.miss_memory_s = 0.0;      // Detections are missed independently of each other.
  config.max_tracks = 4096;
  Tracker tracker(config, VehicleConfig{});
  Judge judge(settings);
  BenchFigures figures;
  std::vector<PoseMeasurement> poses;
  const Detectability answer{.probability = settings.detection_probability};
  const DetectabilityOf detectability = [answer](const LocalTrack&) { return answer; };
  for (std::size_t k = 0; k < recording.size(); ++k) {
    const Frame& frame = recording[k];
    ToMeasurements(frame.detections, settings.noise, poses);
    PoseSensor sensor;
    sensor.period_s = k > 0 ? frame.time_s - recording[k - 1].time_s : 0.1;
    sensor.clutter_per_m2 = settings.clutter_share *
                            static_cast<double>(std::max<std::size_t>(poses.size(), 1)) /
                            SpannedArea(frame.detections);
    sensor.yaw_span_rad = YawSpan(frame.detections);
    sensor.speed_span_mps = Span(frame.detections, &VehiclePose::speed_mps, kSmallestSpeedSpan_mps);
    sensor.yaw_rate_span_radps =
        Span(frame.detections, &VehiclePose::yaw_rate_radps, kSmallestYawRateSpan_radps);
    const double begin_s = watch ? watch() : 0.0;
    tracker.Predict(FromMicros(kEpoch_us) + FromSeconds(frame.time_s));
    tracker.UpdatePoses(sensor, poses, detectability);
    figures.step_ms.push_back(watch ? 1e3 * (watch() - begin_s) : 0.0);
    figures.detections += static_cast<std::int64_t>(poses.size());
    if (snapshots != nullptr) snapshots->push_back(Take(tracker));
    if (static_cast<int>(k) >= settings.skipped_frames) {
      judge.Look(frame, tracker.tracks(), figures);
    }
  }
  return figures;
}

}  // namespace v2vouch::bench
