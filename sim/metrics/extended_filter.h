// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "sim/metrics/information_filter.h"

namespace v2vouch::evaluation {

/// What the class says of a vehicle's size before it is seen, 1 sigma.
struct SizePrior {
  double length_sigma_m = 0.45;
  double width_sigma_m = 0.12;
};
SizePrior SizePriorOf(int object_class);  ///< Constants of track_t.

/// Error covariance of the best estimate of the centre of one vehicle of unknown size, own sensors
/// only, heading and association known. State: position, velocity, acceleration (world frame),
/// length, width, and two errors of its reflections that last from scan to scan.
///
///     range     = u . p - h(L, W) + b_u + white    h: centre to near outline along the sight
///     edges     = w . p +- e(L, W) + b_w + white   e: half the silhouette, |sin| L/2 + |cos| W/2
///     Doppler   = u . v + white
///
/// u, w along and across the line of sight. Radar: white 0.3 m along (beside the sensor's sigma),
/// 0.5 m at each edge (beside range times azimuth sigma), Doppler 0.13 m/s; b_u 0.15 m lasting 3 s,
/// b_w 0.35 half silhouettes lasting 5 s. Camera: both edges, 2 % of the box's width beside the
/// pixel noise and 1.7 times that for its correlation, and the near bottom edge. Source of the
/// figures: 178 000 returns of an independent simulator (docs/results/foreign.md).
class ExtendedFilter {
 public:
  static constexpr int kSize = 10;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  ExtendedFilter(const InformationFilter::Manoeuvre& manoeuvre, const SizePrior& prior);

  void Reset();
  void Predict(double dt_s, double yaw_rad);
  void AddSensor(const SensorSpec& sensor, const PlanarMotion& ego, const PlanarMotion& target,
                 double length_m, double width_m, double detection_probability);
  void Apply();

  [[nodiscard]] double position_variance_m2() const { return P_(0, 0) + P_(1, 1); }

 private:
  void Add(const Vector& row, double sigma, double weight);

  InformationFilter::Manoeuvre manoeuvre_;
  SizePrior prior_;
  Matrix P_ = Matrix::Zero();
  Matrix gathered_ = Matrix::Zero();
  bool has_gathered_ = false;
};

}  // namespace v2vouch::evaluation
