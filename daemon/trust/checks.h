// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "daemon/base/time.h"
#include "daemon/data/finding.h"
#include "daemon/trust/trust_config.h"

namespace v2vouch {

/// One claim beside the LOCAL track it is taken for, both at the claim's time. Raw: no bias of the
/// sender has been taken off, or a slow liar would be calibrated away.
struct CoObservation {
  Timestamp stamp{};
  Eigen::Vector2d residual_O = Eigen::Vector2d::Zero();  ///< Claimed minus sensed [m].
  double alignment_sigma_m = 0.0;  ///< Ego pose error here; not the sender's fault.
  double track_yaw_rad = 0.0;
  double track_speed_mps = 0.0;
  double speed_residual_mps = 0.0;
  double speed_sigma_mps = 0.1;  ///< Of the sensed speed.
  std::optional<double> yaw_residual_rad;
  double yaw_sigma_rad = 0.02;  ///< Of the sensed direction.
};

/// Running means of raw residuals and their history by the second. Copyable, fixed size.
class ResidualHistory {
 public:
  void Add(const CoObservation& observation, const TrustConfig& config);

  [[nodiscard]] bool is_settled() const { return time_s_ >= 1.0; }  ///< One mean time has passed.
  [[nodiscard]] const Eigen::Vector2d& mean_O() const { return mean_; }
  [[nodiscard]] double speed_mps() const { return speed_; }
  [[nodiscard]] double speed_sigma_mps() const { return speed_sigma_; }
  [[nodiscard]] double yaw_rad() const { return yaw_; }
  [[nodiscard]] double yaw_sigma_rad() const { return yaw_sigma_; }
  [[nodiscard]] bool has_yaw() const { return has_yaw_; }
  /// Two-second mean 10 s ago, or the first two seconds where there are not yet 10.
  [[nodiscard]] std::optional<Eigen::Vector2d> reference_O() const;

 private:
  static constexpr std::size_t kBlocks = 12;
  bool has_any_ = false;
  bool has_yaw_ = false;
  Timestamp last_{};
  double time_s_ = 0.0;  // Under observation, gaps over 1 s not counted.
  Eigen::Vector2d mean_ = Eigen::Vector2d::Zero();
  double speed_ = 0.0, speed_sigma_ = 0.0, yaw_ = 0.0, yaw_sigma_ = 0.0;
  std::array<Eigen::Vector2d, kBlocks> blocks_{};  // Means by second, ring.
  std::uint64_t block_count_ = 0;
  Timestamp block_start_{};
  Eigen::Vector2d block_sum_ = Eigen::Vector2d::Zero();
  int block_size_ = 0;
};

/// C8: level of the mean raw residual, along and across the vehicle's direction.
std::optional<Finding> CheckLevel(const ResidualHistory& history, const CoObservation& now,
                                  const TrustConfig& config);
/// C9: its drift against ten seconds ago.
std::optional<Finding> CheckDrift(const ResidualHistory& history, const CoObservation& now,
                                  const TrustConfig& config);
/// C10: claimed against sensed velocity (along and across the vehicle's direction) and direction;
/// limits grow by twice the sensors' own sigma, across also by an honest heading error of 2
/// degrees.
std::optional<Finding> CheckVelocity(const ResidualHistory& history, const CoObservation& now,
                                     const TrustConfig& config);
/// C5: a sender's displacement between two messages against its own claimed motion.
/// @param distance_m from where its last message would have it now.
std::optional<Finding> CheckJump(double distance_m, double dt_s, const TrustConfig& config);

}  // namespace v2vouch
