// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/base/time.h"

namespace v2vouch {

/// Height of one vehicle and the grade of the road under it, from heights along its way: a weighted
/// straight line, old places fading with way (60 m) and old messages with their number (50).
/// Heights of receivers are noisy by metres but slowly, so their differences along the way say
/// more than they do. Copyable, fixed size.
class HeightTrack {
 public:
  /// @param moved_m way since the last call, negative in reverse; counted whether there is a height
  ///        or not.
  void Add(Timestamp stamp, double moved_m, std::optional<double> height_m);

  /// On the line, at the newest position; nullopt where no height was reported in the last 5 s.
  [[nodiscard]] std::optional<double> HeightAt(Timestamp now) const;
  /// Rise per metre ahead as far as it is certain (one sigma nearer to 0); 0 where unknown.
  [[nodiscard]] double grade() const;

 private:
  std::optional<Timestamp> last_;
  double weight_ = 0.0;
  double mean_way_m_ = 0.0;  // From the newest place: <= 0 going forward.
  double mean_height_m_ = 0.0;
  double way_way_ = 0.0;  // Weighted sums of products about the means.
  double way_height_ = 0.0;
  double height_height_ = 0.0;
};

}  // namespace v2vouch
