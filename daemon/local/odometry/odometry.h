// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "daemon/common/base/time.h"
#include "daemon/common/data/ego.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// Dead reckoning of the ego (mid rear axle) in O from speed and yaw rate.
///
///     x' = v cos(yaw),  y' = v sin(yaw),  yaw' = w,  v' = a       (no slip at the rear axle)
///
/// Constant w and a over a step, integrated exactly. Between two samples: the mean of their yaw
/// rates, and the acceleration that leads from one speed to the other. Past the newest sample: its
/// own yaw rate, and its own acceleration; a sensor without one gets the change of speed over the
/// last 0.2 s or more. An unknown yaw rate is the last one, fading within a second (a car does not
/// turn for ever). Extrapolation never turns braking into reversing.
///
/// O starts at the first sample (0, 0, 0). Across a gap longer than kMaxGap_s the pose is carried
/// on by the same rule: O stays continuous, but by a guess. Copyable, fixed size (about 11 kB): a
/// copy is a checkpoint. Holds a short history so that late frames find their pose.
class EgoOdometry {
 public:
  static constexpr double kMaxGap_s = 0.5;

  /// Samples come in order of stamp (the pipeline re-runs late ones). One with the stamp of the
  /// newest replaces it; an older one is ignored.
  /// `gyro_offset_radps`, `speed_factor`: what was corrected in it, for EgoState.
  void OnEgoMotion(const EgoMotion& sample, double gyro_offset_radps = 0.0,
                   double speed_factor = 1.0);

  /// The ego at `t`, from the newest sample with stamp <= t, extrapolated. nullopt: no sample at or
  /// before t, t is older than the history, or that sample is more than kMaxGap_s old (then the
  /// car's motion is not known).
  /// @param max_gap_s larger only where a guess is what is asked for.
  [[nodiscard]] std::optional<EgoState> StateAt(Timestamp t, double max_gap_s = kMaxGap_s) const;

  /// Stamp of the newest sample.
  [[nodiscard]] std::optional<Timestamp> newest() const;

  static constexpr std::size_t kHistory = 128;  ///< Samples: 1.2 s at 100 Hz.

 private:
  /// `age` 0 is the newest sample; `age` < held().
  [[nodiscard]] const EgoState& Sample(std::size_t age) const {
    return history_[(count_ - 1 - age) % kHistory];
  }
  [[nodiscard]] std::size_t held() const { return count_ < kHistory ? count_ : kHistory; }
  [[nodiscard]] double HeldYawRate(Timestamp stamp) const;
  [[nodiscard]] double AccelerationFromSpeeds(Timestamp stamp, double speed_mps) const;

  std::array<EgoState, kHistory> history_{};  // Ring; sample n at n % kHistory.
  std::size_t count_ = 0;                     // Ever taken.
};

}  // namespace v2vouch
