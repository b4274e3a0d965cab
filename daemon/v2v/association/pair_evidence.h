// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/base/time.h"
#include "daemon/v2v/association/association_config.h"

namespace v2vouch {

/// One claim beside one LOCAL track, both at the claim's time, axes of O.
struct PairObservation {
  Timestamp stamp{};
  Eigen::Vector2d residual_m = Eigen::Vector2d::Zero();  ///< Claimed minus sensed, raw.
  Eigen::Matrix2d sensed = Eigen::Matrix2d::Zero();      ///< Covariance of the track's position.
  Eigen::Matrix2d noise = Eigen::Matrix2d::Identity();   ///< White part of the claim.
  Eigen::Matrix2d alignment = Eigen::Matrix2d::Zero();   ///< Ego pose error; slow, like a bias.
  Eigen::Matrix2d stale = Eigen::Matrix2d::Zero();  ///< Along track: positions older than said.
  double speed_residual_mps = 0.0;
  double speed_sigma_mps = 0.3;            ///< Of the residual: claim and track together.
  std::optional<double> yaw_residual_rad;  ///< Where both directions mean something.
  double yaw_sigma_rad = 0.1;
};

/// Prior of a sender's bias in O, where one is known.
struct BiasPrior {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
};

/// Evidence that a sender is a LOCAL track, accumulated over messages.
///
///     score = sum of fading ln [ N(residual; bias, S) N(speed) N(yaw) / background ]  -  level
///     level = b^T (B0 + stale)^-1 b / 2
///
/// The bias b of the sender is filtered beside (Gauss-Markov, prior B0), so S shrinks as it is
/// learnt; its level is charged separately, because the innovations forget it and a car that
/// drives in parallel in the next lane would look like a well-learnt bias.
/// Copyable, fixed size.
class PairEvidence {
 public:
  PairEvidence(const AssociationConfig& config, const std::optional<BiasPrior>& prior,
               const PairObservation& first);

  void Add(const PairObservation& observation, const AssociationConfig& config);

  [[nodiscard]] double score() const { return fading_ - level_; }
  /// How unlikely the learnt bias is. A neighbour that moves like the track, at any distance,
  /// agrees with it message by message once its offset is learnt: only the level distinguishes the
  /// neighbour from the track itself, however long the agreement lasts.
  [[nodiscard]] double level() const { return level_; }
  /// The same, were the sender another vehicle, so far from the track [m, axes of O].
  [[nodiscard]] double LevelBeside(const Eigen::Vector2d& offset_O) const {
    const Eigen::Vector2d b = bias_ - offset_O;
    return 0.5 * b.dot(level_information_ * b);
  }
  [[nodiscard]] int observations() const { return observations_; }
  [[nodiscard]] Timestamp first() const { return first_; }
  [[nodiscard]] Timestamp last() const { return last_; }
  [[nodiscard]] double span_s() const { return ToSeconds(last_ - first_); }
  [[nodiscard]] double mean_nis() const { return mean_nis_; }
  /// Mean NIS (2 dof) below the upper end of its 99 % band, and the latest within the 99 % gate:
  /// a message that shows that the track has switched elsewhere validates no sender. A low NIS is a
  /// sender more accurate than it reports, which is no fault.
  [[nodiscard]] bool is_nis_consistent() const;
  /// Mean of claimed minus sensed speed over the last 20 messages within max_speed_mps and the
  /// mean sigma. A car that passes in the next lane may pair for seconds with a bias that moves
  /// along; its speed shows the difference at once.
  [[nodiscard]] bool is_speed_consistent(const AssociationConfig& config) const;
  [[nodiscard]] const Eigen::Vector2d& bias() const { return bias_; }
  [[nodiscard]] const Eigen::Matrix2d& bias_covariance() const { return bias_covariance_; }

 private:
  Timestamp first_{};
  Timestamp last_{};
  int observations_ = 0;
  double fading_ = 0.0;
  double level_ = 0.0;
  Eigen::Matrix2d level_information_ = Eigen::Matrix2d::Identity();  // (B0 + stale)^-1
  double mean_nis_ = 0.0;
  double latest_nis_ = 0.0;
  double mean_speed_ = 0.0;  // Of the residual; its sigma beside.
  double mean_speed_sigma_ = 0.0;
  Eigen::Vector2d bias_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d bias_covariance_ = Eigen::Matrix2d::Identity();
};

}  // namespace v2vouch
