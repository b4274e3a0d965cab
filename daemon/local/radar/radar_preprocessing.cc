// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/radar/radar_preprocessing.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/outline.h"

namespace v2vouch {
namespace {

Eigen::Vector2d Direction(double azimuth_rad) {
  return {std::cos(azimuth_rad), std::sin(azimuth_rad)};
}

// 1 sigma of the ground range rate of one reflection.
double GroundRateSigma(const Eigen::Vector2d& ray, const AntennaMotion& antenna,
                       const RadarConfig& radar, const EgoState& ego) {
  const double across_mps = ray.x() * antenna.velocity_R.y() - ray.y() * antenna.velocity_R.x();
  const double from_azimuth = across_mps * radar.azimuth_sigma_rad;
  const double from_yaw_rate = antenna.lever_arm_m * ego.yaw_rate_sigma_radps;
  return std::sqrt(radar.range_rate_sigma_mps * radar.range_rate_sigma_mps +
                   from_azimuth * from_azimuth + ego.speed_sigma_mps * ego.speed_sigma_mps +
                   from_yaw_rate * from_yaw_rate);
}

// What tells strong reflections of one vehicle from weak ones.
double StrengthOf(const RadarDetection& detection) {
  if (std::isfinite(detection.snr_db)) return detection.snr_db;
  return std::isfinite(detection.rcs_dbsm) ? detection.rcs_dbsm : 0.0;
}

bool ByAzimuthThenRange(const RadarMeasurement& a, const RadarMeasurement& b) {
  return std::tie(a.azimuth_rad, a.range_m, a.range_rate_mps, a.object_id) <
         std::tie(b.azimuth_rad, b.range_m, b.range_rate_mps, b.object_id);
}

// Of a cluster's returns on its outline, in R.
struct OutlineMean {
  Eigen::Vector2d p_R = Eigen::Vector2d::Zero();
  double ground_rate_mps = 0.0;
  double count = 0.0;
};

// Marks those returns as well.
OutlineMean MeanOfOutline(std::span<const int> members, std::span<const OutlineReturn> outline,
                          std::span<Reflection> reflections) {
  OutlineMean mean;
  for (const int member : members) {
    Reflection& r = reflections[static_cast<std::size_t>(member)];
    r.is_outline = std::ranges::any_of(outline, [&](const OutlineReturn& o) {
      return o.range_m == r.range_m && o.azimuth_rad == r.azimuth_rad;
    });
    if (!r.is_outline) continue;
    mean.p_R += Eigen::Vector2d(r.x_m, r.y_m);
    mean.ground_rate_mps += r.ground_rate_mps;
    mean.count += 1.0;
  }
  mean.p_R /= mean.count;
  mean.ground_rate_mps /= mean.count;
  return mean;
}

// Range and azimuth that all the returns of a cluster fill, about its mean azimuth.
void MeasureEdges(std::span<const int> members, std::span<const Reflection> reflections,
                  RadarMeasurement& m) {
  double nearest_m = reflections[static_cast<std::size_t>(members[0])].range_m;
  double farthest_m = nearest_m;
  double right_rad = 0.0;
  double left_rad = 0.0;
  double middle_rad = 0.0;
  for (const int member : members) {
    const Reflection& r = reflections[static_cast<std::size_t>(member)];
    nearest_m = std::min(nearest_m, r.range_m);
    farthest_m = std::max(farthest_m, r.range_m);
    const double aside_rad = AngleDifference(r.azimuth_rad, m.azimuth_rad);
    right_rad = std::min(right_rad, aside_rad);
    left_rad = std::max(left_rad, aside_rad);
    middle_rad += aside_rad;
  }
  m.near_range_m = nearest_m;
  m.radial_extent_m = farthest_m - nearest_m;
  m.middle_azimuth_rad = m.azimuth_rad + middle_rad / static_cast<double>(members.size());
  m.azimuth_min_rad = m.azimuth_rad + right_rad;
  m.azimuth_max_rad = m.azimuth_rad + left_rad;
}

// Sums of the squared deviations of the outline's returns in range, azimuth and ground range rate.
Eigen::Array3d SquaresOfOutline(std::span<const int> members,
                                std::span<const Reflection> reflections, const OutlineMean& mean,
                                const RadarMeasurement& m) {
  const Eigen::Vector2d ray = Direction(m.azimuth_rad);
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  for (const int member : members) {
    const Reflection& r = reflections[static_cast<std::size_t>(member)];
    if (!r.is_outline) continue;
    const Eigen::Vector2d off = Eigen::Vector2d(r.x_m, r.y_m) - mean.p_R;
    const double along_m = off.dot(ray);
    const double across_rad = (ray.x() * off.y() - ray.y() * off.x()) / m.range_m;
    const double rate_mps = r.ground_rate_mps - mean.ground_rate_mps;
    squares += Eigen::Array3d(along_m, across_rad, rate_mps).square();
  }
  return squares;
}

}  // namespace

AntennaMotion MotionOfAntenna(const RadarConfig& radar, const EgoState& ego) {
  const Eigen::Vector2d velocity_B(ego.speed_mps - ego.yaw_rate_radps * radar.y_m,
                                   ego.yaw_rate_radps * radar.x_m);
  const Pose<Body, Radar> X_BR(radar.x_m, radar.y_m, radar.yaw_rad);
  return {X_BR.rotation().transpose() * velocity_B, std::hypot(radar.x_m, radar.y_m)};
}

bool RadarPreprocessor::IsKept(const RadarDetection& detection, const RadarConfig& radar) const {
  if (!std::isfinite(detection.range_m) || !std::isfinite(detection.azimuth_rad) ||
      !std::isfinite(detection.range_rate_mps)) {
    return false;
  }
  if (detection.range_m <= 0.0 || detection.range_m < radar.min_range_m ||
      detection.range_m > radar.max_range_m) {
    return false;
  }
  if (std::abs(WrapAngle(detection.azimuth_rad)) >
      radar.half_fov_rad + 3.0 * radar.azimuth_sigma_rad) {
    return false;
  }
  // A NaN compares false: what the sensor does not measure drops nothing.
  if (detection.snr_db < config_.min_snr_db) return false;
  const double doublings = std::max(0.0, std::log2(detection.range_m / 10.0));
  return !(detection.rcs_dbsm < config_.min_rcs_dbsm + config_.rcs_slope_db * doublings);
}

void RadarPreprocessor::Process(const RadarScan& scan, const RadarConfig& radar,
                                const EgoState& ego, std::vector<RadarMeasurement>& measurements) {
  measurements.clear();
  reflections_.clear();
  const AntennaMotion antenna = MotionOfAntenna(radar, ego);
  for (const RadarDetection& detection : scan.detections) {
    if (!IsKept(detection, radar)) continue;
    const Eigen::Vector2d ray = Direction(detection.azimuth_rad);
    const double ground_rate_mps = detection.range_rate_mps + antenna.velocity_R.dot(ray);
    const double tolerance_mps =
        std::max(config_.static_speed_mps, 3.0 * GroundRateSigma(ray, antenna, radar, ego));
    reflections_.push_back({.range_m = detection.range_m,
                            .azimuth_rad = WrapAngle(detection.azimuth_rad),
                            .x_m = detection.range_m * ray.x(),
                            .y_m = detection.range_m * ray.y(),
                            .ground_rate_mps = ground_rate_mps,
                            .strength_db = StrengthOf(detection),
                            .is_standing = std::abs(ground_rate_mps) <= tolerance_mps,
                            .object_id = detection.track_id});
  }
  // By content, not by place in the list: the order in which a sensor lists them says nothing.
  std::sort(reflections_.begin(), reflections_.end(), [](const auto& a, const auto& b) {
    return std::tie(a.range_m, a.azimuth_rad, a.ground_rate_mps, a.object_id) <
           std::tie(b.range_m, b.azimuth_rad, b.ground_rate_mps, b.object_id);
  });
  order_.clear();  // Moving ones first: the two kinds are clustered apart.
  for (const bool is_standing : {false, true}) {
    for (std::size_t i = 0; i < reflections_.size(); ++i) {
      if (reflections_[i].is_standing == is_standing) order_.push_back(static_cast<int>(i));
    }
    if (!is_standing) moving_ = order_.size();
  }

  if (radar.output == RadarOutput::kObjects) {
    for (const int& member : order_) Emit({&member, 1}, radar, antenna, measurements);
  } else {
    Cluster();
    if (config_.vehicle_gap_m > 0.0) {
      // The tolerance of Doppler holds the same terms as that of standing, at the worst azimuth.
      const double across_mps = antenna.velocity_R.norm() * radar.azimuth_sigma_rad;
      merge_.Run(reflections_,
                 {.gap_m = config_.vehicle_gap_m,
                  .length_m = config_.vehicle_length_m,
                  .width_m = config_.vehicle_width_m,
                  .range_sigma_m = radar.range_sigma_m,
                  .azimuth_sigma_rad = radar.azimuth_sigma_rad,
                  .ground_rate_sigma_mps = std::hypot(radar.range_rate_sigma_mps, across_mps)},
                 clustered_, ends_);
    }
    std::size_t from = 0;
    for (const std::size_t to : ends_) {
      Emit(std::span(clustered_).subspan(from, to - from), radar, antenna, measurements);
      from = to;
    }
  }
  for (RadarMeasurement& measurement : measurements) measurement.radar = scan.radar;
  std::sort(measurements.begin(), measurements.end(), ByAzimuthThenRange);
}

// Clusters the reflections and keeps the clusters that are short enough; the others are tried again
// with a smaller radius: a car's reflections lie closer together than a wall's.
void RadarPreprocessor::Cluster() {
  constexpr double kShrink = 0.6;
  constexpr int kDeepest = 3;
  clustered_.clear();
  ends_.clear();
  pieces_.assign({{0, moving_, 0}, {moving_, order_.size(), 0}});
  while (!pieces_.empty()) {
    const Piece piece = pieces_.back();
    pieces_.pop_back();
    const auto members = std::span(order_).subspan(piece.begin, piece.end - piece.begin);
    const bool is_standing = piece.begin >= moving_;
    const std::size_t whole = members.size();
    std::span<const std::size_t> ends(&whole, 1);
    if (piece.depth <= kDeepest) {
      ends = dbscan_.Run(reflections_,
                         {.eps_m = is_standing ? config_.static_eps_m : config_.eps_m,
                          .eps_per_m = is_standing ? config_.static_eps_per_m : config_.eps_per_m,
                          .eps_speed_mps = config_.eps_speed_mps,
                          .min_points = config_.min_points,
                          .scale = std::pow(kShrink, piece.depth)},
                         members);
    }
    std::size_t from = 0;
    for (const std::size_t to : ends) {
      const auto cluster = members.subspan(from, to - from);
      const std::size_t begin = piece.begin + from;
      const std::size_t end = piece.begin + to;
      from = to;
      if (cluster.empty()) continue;
      Eigen::Vector2d low(1e9, 1e9);
      Eigen::Vector2d high(-1e9, -1e9);
      for (const int member : cluster) {
        const Reflection& r = reflections_[static_cast<std::size_t>(member)];
        low = low.cwiseMin(Eigen::Vector2d(r.x_m, r.y_m));
        high = high.cwiseMax(Eigen::Vector2d(r.x_m, r.y_m));
      }
      const Eigen::Vector2d size = high - low;
      if (size.norm() <= (is_standing ? config_.max_static_length_m : config_.max_length_m)) {
        clustered_.insert(clustered_.end(), cluster.begin(), cluster.end());
        ends_.push_back(clustered_.size());
      } else if (piece.depth < kDeepest) {
        pieces_.push_back({begin, end, piece.depth + 1});
      } else {
        // Still one piece: cut it across its longer side. Stable, so that halves stay in order.
        const bool along_x = size.x() >= size.y();
        const double middle = along_x ? 0.5 * (low.x() + high.x()) : 0.5 * (low.y() + high.y());
        const auto second = std::stable_partition(cluster.begin(), cluster.end(), [&](int member) {
          const Reflection& r = reflections_[static_cast<std::size_t>(member)];
          return (along_x ? r.x_m : r.y_m) < middle;
        });
        const std::size_t cut = begin + static_cast<std::size_t>(second - cluster.begin());
        pieces_.push_back({begin, cut, kDeepest + 1});
        pieces_.push_back({cut, end, kDeepest + 1});
      }
    }
  }
}

void RadarPreprocessor::Emit(std::span<const int> members, const RadarConfig& radar,
                             const AntennaMotion& antenna,
                             std::vector<RadarMeasurement>& measurements) {
  const auto at = [&](int member) -> const Reflection& {
    return reflections_[static_cast<std::size_t>(member)];
  };
  RadarMeasurement m;
  m.is_object = radar.output == RadarOutput::kObjects;
  outline_.clear();
  for (const int member : members) {
    const Reflection& r = at(member);
    outline_.push_back({r.range_m, r.azimuth_rad, r.strength_db});
  }
  if (!m.is_object) outline_.resize(KeepOutline(outline_));
  const OutlineMean mean = MeanOfOutline(members, outline_, reflections_);
  m.returns = static_cast<int>(members.size());
  // Reflections all round a very close sensor may average to its very place.
  m.range_m = std::max(mean.p_R.norm(), 0.01);
  m.azimuth_rad = std::atan2(mean.p_R.y(), mean.p_R.x());
  m.ground_range_rate_mps = mean.ground_rate_mps;
  m.range_rate_mps = mean.ground_rate_mps - antenna.velocity_R.dot(Direction(m.azimuth_rad));
  m.is_static = at(members[0]).is_standing;
  m.object_id = members.size() == 1 ? at(members[0]).object_id : -1;
  MeasureEdges(members, reflections_, m);
  if (!m.is_object) {
    m.outline_count = std::min(outline_.size(), RadarMeasurement::kMostOutline);
    std::copy_n(outline_.begin(), m.outline_count, m.outline.begin());
  }
  const Eigen::Array3d noise =
      Eigen::Array3d(radar.range_sigma_m, radar.azimuth_sigma_rad, radar.range_rate_sigma_mps)
          .square();
  const Eigen::Array3d squares = SquaresOfOutline(members, reflections_, mean, m);
  const Eigen::Array3d spread = squares / std::max(1.0, mean.count - 1.0);
  m.covariance = Eigen::Matrix3d((noise.max(spread) / mean.count).matrix().asDiagonal());
  measurements.push_back(m);
}

}  // namespace v2vouch
