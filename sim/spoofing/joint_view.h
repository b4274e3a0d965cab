// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/metrics/footprint.h"
#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {

/// A true vehicle's box at one instant.
struct TrueBox {
  std::size_t object = 0;  ///< Index into Truth::objects.
  Footprint box;
};

/// Boxes of all true vehicles (pedestrians and cyclists are none) at `t`, in order of their ids.
std::vector<TrueBox> TrueBoxes(const Truth& truth, Timestamp t);

/// Whether the ego's sensors could check a claimed place, by true geometry alone:
///
///   - 5..100 m from the ego's rear axle,
///   - within the field of view and range of sensors of two kinds (of the one kind where boxes are
///     all there is),
///   - from each of those, no true vehicle and no building on the straight line to it.
///
/// A vehicle whose box the place is in does not stand in its own way; nor does the sender's own
/// vehicle where the place is within `kOwnBox_m` of it (an honest claim is off by its GNSS error).
/// Heights are left out: a lorry behind a car counts as hidden.
class JointView {
 public:
  static constexpr double kNearest_m = 5.0;
  static constexpr double kFarthest_m = 100.0;
  static constexpr double kOwnBox_m = 3.0;

  explicit JointView(const RunLog& log) : log_(log) {}

  /// @param own_vehicle TruthObject::id the sender speaks for; 0 = none.
  /// Calls with rising times are cheap: the scene is kept for 10 ms.
  bool Sees(Timestamp t, const Eigen::Vector2d& place_W, std::int64_t own_vehicle);

 private:
  void MoveTo(Timestamp t);
  [[nodiscard]] bool IsClear(const Eigen::Vector2d& from_W, const Eigen::Vector2d& place_W,
                             std::int64_t own_vehicle) const;

  const RunLog& log_;
  std::int64_t tick_ = INT64_MIN;
  std::optional<Pose<World, Body>> X_WB_;
  std::vector<TrueBox> boxes_;
};

}  // namespace v2vouch::evaluation
