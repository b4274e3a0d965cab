// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "daemon/warnings/draws.h"
#include "daemon/warnings/prediction.h"

namespace v2vouch::warnings {

/// One engine for FCW, LTA and IMA: what the predicted motions of two bodies come to.
struct Conflict {
  double probability = 0.0;        ///< Share of the draws in which the bodies touch.
  double probability_exact = 0.0;  ///< The same without the margin round the ego.
  double median_s = kNaN;          ///< Of the first touch, over the draws that touch.
  double early_s = kNaN;           ///< 10 % quantile.
  double exact_median_s = kNaN;
  /// Over the draws within `hidden_sigmas` of the mean: the earliest touch; NaN = none. The
  /// reachable set of a vehicle that no sensor sees.
  double reachable_s = kNaN;
  /// Mean motions: smallest |t_ego - t_other| over the pairs of instants at which the two bodies
  /// would stand in each other's place (0: they meet). NaN: the paths do not touch.
  double post_encroachment_s = kNaN;
  double ego_enters_s = kNaN;  ///< First instant of the ego in one of these pairs.
  double other_enters_s = kNaN;
  Eigen::Vector2d place_B{kNaN, kNaN};  ///< The ego's centre at the conflict.
};

/// Target in the ego's body frame now.
struct BodyTarget {
  StateVector mean = StateVector::Zero();
  StateMatrix covariance = StateMatrix::Zero();
  HalfSize size;
};

/// What the ego knows of its own motion.
struct EgoSigmas {
  double speed_mps = 0.1;
  double yaw_rate_radps = 0.005;
};

/// The ego's motion under one plan: as planned, and five speeds times five curvatures that stand
/// for its distribution, which is narrow. Made once, used for all targets.
class EgoFan {
 public:
  EgoFan(const EgoPlan& plan, const EgoSigmas& sigmas, const EgoBody& body,
         const WarningsConfig& config);
  [[nodiscard]] const Motion& mean() const { return mean_; }
  /// That of two standard normal numbers.
  [[nodiscard]] const Motion& Of(double z_speed, double z_yaw_rate) const;
  /// Its centre moves no further than this in one step, under any of these.
  [[nodiscard]] double longest_step_m() const { return longest_step_m_; }
  [[nodiscard]] int steps() const { return static_cast<int>(mean_.size()) - 1; }
  [[nodiscard]] const HalfSize& exact() const { return exact_; }
  [[nodiscard]] const HalfSize& wide() const { return wide_; }  ///< With body_margin_m.

 private:
  HalfSize exact_;
  HalfSize wide_;
  Motion mean_;
  std::array<Motion, 25> fan_;
  double longest_step_m_ = 0.0;
};

Conflict AssessConflict(const EgoFan& ego, const BodyTarget& target, const WarningsConfig& config);

/// The gap between the two mean motions alone.
void AssessGap(const Motion& ego, const HalfSize& ego_size, const Motion& other,
               const HalfSize& other_size, Conflict& conflict);

}  // namespace v2vouch::warnings
