// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "daemon/base/time.h"
#include "daemon/data/ego.h"
#include "daemon/data/input.h"

namespace v2vouch {

/// Dead reckoning of the ego in O from speed and yaw rate: constant turn rate and acceleration
/// between samples. The pose at t uses samples with stamp <= t, extrapolated by at most
/// `max_gap_s`. O starts at the first sample (0, 0, 0). Copyable; holds a short history so that
/// late frames find their pose.
class EgoOdometry {
 public:
  /// Samples must come in order of stamp (the pipeline re-runs late ones).
  void OnEgoMotion(const EgoMotion& sample);

  /// The ego at `t`. nullopt: no sample at or before t, t is older than the history, or the last
  /// sample before t is more than max_gap_s old (then the car's motion is not known).
  [[nodiscard]] std::optional<EgoState> StateAt(Timestamp t) const;

  [[nodiscard]] std::optional<Timestamp> newest() const;
  static constexpr double kMaxGap_s = 0.5;

 private:
  static constexpr std::size_t kHistory = 128;  // 1.2 s at 100 Hz.
  std::array<EgoState, kHistory> history_{};
  std::size_t count_ = 0;
};

}  // namespace v2vouch
