// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "daemon/common/base/time.h"
#include "daemon/common/data/finding.h"
#include "daemon/common/data/track.h"
#include "daemon/v2v/trust/trust_config.h"

namespace v2vouch {

/// One claim beside the LOCAL track it is taken for, both at the claim's time. Raw: no bias of the
/// sender has been taken off, or a slow liar would be calibrated away.
struct CoObservation {
  Timestamp stamp{};
  Eigen::Vector2d residual_O = Eigen::Vector2d::Zero();  ///< Claimed minus sensed [m].
  double alignment_sigma_m = 0.0;  ///< Ego pose error here; not the sender's fault.
  /// Claimed minus sensed velocity; unknown where no course is claimed.
  std::optional<Eigen::Vector2d> velocity_residual_O;
  double track_yaw_rad = 0.0;
  double track_speed_mps = 0.0;
  double speed_residual_mps = 0.0;
  double speed_sigma_mps = 0.1;  ///< Of the sensed speed.
  std::optional<double> yaw_residual_rad;
  double yaw_sigma_rad = 0.02;  ///< Of the sensed direction.
  double accel_residual_mps2 = 0.0;
  double accel_sigma_mps2 = 0.5;  ///< Of the sensed acceleration.
  double sensed_sigma_m = 0.0;    ///< Of the sensed position, by which the sensors may be wrong.
  double extent_sigma_m = 0.0;    ///< ... and its centre along the track: half of the length's.
  /// Partial observation, which may drag the track along: skip the level checks, keep the check for
  /// a residual jump.
  bool is_partial = false;
  /// Complete observations have not lasted long enough since: differences cause no blame.
  bool is_doubtful = false;
  bool is_own_motion_whole = true;  ///< The sender's messages have lately continued each other.
  bool is_plausible = true;         ///< Of the pair: agreement by a large bias clears no sender.
  bool is_ego_shifted = false;  ///< Common mode: `shift_O` is our own fault, its history unknown.
  Eigen::Vector2d shift_O = Eigen::Vector2d::Zero();
};

/// Running means of raw residuals and their history by the second. Copyable, fixed size.
class ResidualHistory {
 public:
  void Add(const CoObservation& observation, const TrustConfig& config);

  /// Means and reference start again; the check for a residual jump goes on.
  void Restart();

  [[nodiscard]] bool is_settled() const { return time_s_ >= 1.0; }  ///< One mean time has passed.
  [[nodiscard]] const Eigen::Vector2d& mean_O() const { return mean_; }
  /// How fast the residual moves: difference of a fast and a slow mean over that of their times.
  [[nodiscard]] Eigen::Vector2d rate_O(const TrustConfig& config) const {
    return (fast_mean_ - mean_) / ((1.0 - kFastShare) * config.mean_time_s);
  }
  [[nodiscard]] const Eigen::Vector2d& fast_mean_O() const { return fast_mean_; }
  [[nodiscard]] double speed_mps() const { return speed_; }
  [[nodiscard]] double speed_sigma_mps() const { return speed_sigma_; }
  [[nodiscard]] double yaw_rad() const { return yaw_; }
  [[nodiscard]] double yaw_sigma_rad() const { return yaw_sigma_; }
  [[nodiscard]] bool has_yaw() const { return has_yaw_; }
  [[nodiscard]] double sensed_sigma_m() const { return sensed_sigma_; }
  /// Fading by ten mean times, the span of a drift.
  [[nodiscard]] double extent_sigma_m() const { return extent_sigma_; }
  [[nodiscard]] double accel_mps2() const { return accel_; }  ///< Mean of three mean times.
  [[nodiscard]] double accel_sigma_mps2() const { return accel_sigma_; }
  [[nodiscard]] double time_s() const { return time_s_; }
  [[nodiscard]] Timestamp last() const { return last_; }
  /// Residual jump: within a second the residual changed by more than torn_m (and 0.05 s of speed,
  /// and twice the sensors' own sigma) beyond what both motions explain.
  [[nodiscard]] bool is_torn() const { return is_torn_; }
  [[nodiscard]] double torn_m() const { return torn_m_; }  ///< By how much.
  /// Two-second mean 10 s ago, or the first two seconds where there are not yet 10.
  [[nodiscard]] std::optional<Eigen::Vector2d> reference_O() const;
  /// The track's speed then; 0 where there is no reference.
  [[nodiscard]] double reference_speed_mps() const;
  /// By how much the claimed and the sensed velocity alone have parted the two since then [m].
  [[nodiscard]] std::optional<Eigen::Vector2d> walked_O() const;

 private:
  static constexpr std::size_t kBlocks = 12;
  static constexpr double kFastShare = 0.3;  // Of mean_time_s.
  void LookForTear(const CoObservation& observation, const TrustConfig& config);

  bool has_any_ = false;
  bool has_yaw_ = false;
  bool is_torn_ = false;
  double torn_m_ = 0.0;
  Timestamp last_{};
  std::optional<Timestamp> last_step_;
  Eigen::Vector2d last_residual_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d unexplained_ = Eigen::Vector2d::Zero();  // Fading sum of such steps.
  double time_s_ = 0.0;  // Under observation, gaps over 1 s not counted.
  Eigen::Vector2d mean_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d fast_mean_ = Eigen::Vector2d::Zero();
  double speed_ = 0.0, speed_sigma_ = 0.0, yaw_ = 0.0, yaw_sigma_ = 0.0;
  double accel_ = 0.0, accel_sigma_ = 0.0;
  double sensed_sigma_ = 0.0, extent_sigma_ = 0.0;
  Eigen::Vector2d walked_ = Eigen::Vector2d::Zero();  // Integral of the velocity residual.
  using Block = Eigen::Matrix<double, 5, 1>;          // Residual, the track's speed, walked_.
  std::array<Block, kBlocks> blocks_{};               // Means by second, ring.
  std::uint64_t block_count_ = 0;
  Timestamp block_start_{};
  [[nodiscard]] Block Reference() const;  // Of at least two blocks.
  Block block_sum_ = Block::Zero();
  int block_size_ = 0;
};

/// Whether one residual alone exceeds the level at which its mean would be withdrawn; what the
/// sensors doubt of themselves does not count.
bool IsFarApart(const CoObservation& now, const TrustConfig& config);

/// residual_level: level of the mean raw residual, along and across the vehicle's direction.
std::optional<Finding> CheckLevel(const ResidualHistory& history, const CoObservation& now,
                                  const TrustConfig& config);
/// residual_drift: its drift against ten seconds ago. A position older than its stamp shifts along
/// the track by what the speed has changed since, and by little otherwise.
std::optional<Finding> CheckDrift(const ResidualHistory& history, const CoObservation& now,
                                  const TrustConfig& config);
/// velocity_residual: claimed against sensed velocity (along and across the vehicle's direction)
/// and direction; limits grow by twice the sensors' own sigma, across also by an honest heading
/// error of 2 degrees. A false velocity beside true places is the message stream's to find; what
/// counts here is a sender that leaves its vehicle, so the residual of the position must move with
/// that of the velocity, by half of it at least, and have come leaving_m from its reference. Where
/// it does not, the sensors have the velocity wrong.
std::optional<Finding> CheckVelocity(const ResidualHistory& history, const CoObservation& now,
                                     const TrustConfig& config);
/// acceleration_residual: claimed against sensed acceleration over three mean times. Sensors follow
/// hard braking late, so a shorter disagreement says nothing.
std::optional<Finding> CheckAcceleration(const ResidualHistory& history, const CoObservation& now,
                                         const TrustConfig& config);
/// Whether the sender walks off its vehicle: by leaving_m its residual has moved from where it was
/// ten seconds ago, and the claimed velocity has parted it from the sensed one by as much, the same
/// way. A receiver's error wanders without a velocity, and a false velocity alone moves nothing.
/// Both grow by twice the sensors' own sigma. No reason for blame, as the sensors may have followed
/// the wrong reflections; but nothing that a bridge may rest on.
bool IsWalkingOff(const ResidualHistory& history, const TrustConfig& config);
/// plausible size: whether claimed and sensed size can be of one vehicle. Twice the sensors' own
/// sigma is allowed beside the mismatch; a size that is not claimed fits.
bool IsSizePlausible(const std::optional<double>& length_m, const std::optional<double>& width_m,
                     const Extent& sensed, const TrustConfig& config);

}  // namespace v2vouch
