// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "daemon/common/base/time.h"

namespace v2vouch {

/// Whether a LOCAL track keeps kinematic limits. A track that switches to another car, or whose
/// reflection runs along a vehicle's side, changes its velocity faster than tyres allow:
///
///     |v(t) - v(t - dt)| > 8 m/s^2 dt + 1.5 m/s      for some dt up to 0.6 s
///
/// and a residual to its sender is then caused by the sensors. The track's own sigma does not
/// matter. Copyable, fixed size.
class TrackMotion {
 public:
  /// A velocity of the track [m/s, axes of O], in order of time; earlier ones are ignored.
  /// @return whether it exceeded them just now.
  bool Observe(Timestamp stamp, const Eigen::Vector2d& velocity_O);

  /// The limits were exceeded within the last 3 s: residuals cause no blame.
  [[nodiscard]] bool HasBroken(Timestamp now) const;

 private:
  struct Sample {
    Timestamp stamp{};
    Eigen::Vector2d velocity_O = Eigen::Vector2d::Zero();
  };
  static constexpr std::size_t kSamples = 8;
  std::array<Sample, kSamples> samples_{};  // Ring.
  std::uint64_t count_ = 0;
  std::optional<Timestamp> broke_;
};

}  // namespace v2vouch
