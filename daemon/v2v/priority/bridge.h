// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/base/time.h"
#include "daemon/common/base/visit.h"
#include "daemon/common/data/missed_detection.h"
#include "daemon/common/data/track.h"
#include "daemon/common/models/ctra.h"

namespace v2vouch {

/// How long and how far V2V may carry a vehicle that no sensor sees.
struct BridgeConfig {
  double base_s = 2.0;             ///< Budget = base_s + co-observed time, ...
  double least_s = 4.5;            ///< ... at least this once validated, ...
  double most_s = 10.0;            ///< ... never more than this.
  double support_s = 0.35;         ///< A hit younger than this is sensor support.
  int regain_hits = 3;             ///< Hits after a gap that count as support again.
  double max_gap_s = 1.0;          ///< Between messages while hidden.
  double max_silence_s = 2.0;      ///< Between messages while seen; then it is LOCAL's alone.
  double max_sigma_m = 3.0;        ///< Position less certain than this is worth nothing.
  double reach_along_m = 3.0;      ///< Reachable set round the sensor-only coast: along ...
  double reach_along_mps2 = 2.5;   ///< ... + half of this t^2,
  double reach_across_m = 1.5;     ///< across ...
  double reach_across_mps2 = 3.0;  ///< ... + half of this t^2: an honest turn stays inside.
  double reach_most_m = 6.5;       ///< Never farther than this: what a liar can do, however long.
  double max_distance_m = 100.0;   ///< From the ego; farther off the coast itself says too little.
  double part_share = 0.6;         ///< Less of a vehicle visible: measured by a part of it.
  int max_misfits = 3;             ///< Claims in a row that do not fit the bridge end it.
  double look_s = 0.3;             ///< empty_place: at most one observation per this time.
  double least_detection = 0.5;    ///< empty_place: floor of the detection probability.
  double false_detection = kFalseDetection;  ///< empty_place: chance of a hit where nothing is.
  double clear_doubt =
      kClearDoubt;                ///< empty_place: chance that what the map calls clear is covered.
  double empty_log_ratio = -4.6;  ///< empty_place: the place is empty; withdraw.
  double contradiction_m = 5.0;   ///< The real vehicle seen this far from the bridge ends it.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("base_s", base_s, {.at_least = 0.0, .at_most = 30.0});
    a.Field("least_s", least_s, {.at_least = 0.0, .at_most = 30.0});
    a.Field("most_s", most_s, {.at_least = 0.0, .at_most = 30.0});
    a.Field("support_s", support_s, {.above = 0.0, .at_most = 2.0});
    a.Field("regain_hits", regain_hits, {.at_least = 1, .at_most = 20});
    a.Field("max_gap_s", max_gap_s, {.above = 0.1, .at_most = 10.0});
    a.Field("max_silence_s", max_silence_s, {.above = 0.1, .at_most = 30.0});
    a.Field("max_sigma_m", max_sigma_m, {.above = 0.1, .at_most = 20.0});
    a.Field("reach_along_m", reach_along_m, {.at_least = 0.0, .at_most = 20.0});
    a.Field("reach_along_mps2", reach_along_mps2, {.at_least = 0.0, .at_most = 20.0});
    a.Field("reach_across_m", reach_across_m, {.at_least = 0.0, .at_most = 20.0});
    a.Field("reach_across_mps2", reach_across_mps2, {.at_least = 0.0, .at_most = 20.0});
    a.Field("reach_most_m", reach_most_m, {.above = 0.0, .at_most = 100.0});
    a.Field("max_distance_m", max_distance_m, {.above = 1.0, .at_most = 500.0});
    a.Field("part_share", part_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("max_misfits", max_misfits, {.at_least = 1, .at_most = 100});
    a.Field("look_s", look_s, {.above = 0.01, .at_most = 5.0});
    a.Field("least_detection", least_detection, {.above = 0.0, .below = 1.0});
    a.Field("false_detection", false_detection, {.at_least = 0.0, .below = 0.5});
    a.Field("clear_doubt", clear_doubt, {.at_least = 0.0, .below = 1.0});
    a.Field("empty_log_ratio", empty_log_ratio, {.at_least = -100.0, .below = 0.0});
    a.Field("contradiction_m", contradiction_m, {.above = 0.5, .at_most = 50.0});
  }
};

/// T = min(most, base + co-observed), at least `least`.
double BridgeBudget_s(double co_observed_s, const BridgeConfig& config);

/// A vehicle as it was known when it was last seen, predicted without V2V. Copyable, fixed size.
class Coast {
 public:
  Coast() = default;
  Coast(const KinematicState& seen, Timestamp stamp);

  void PredictTo(Timestamp stamp, const MotionNoise& motion);
  [[nodiscard]] const KinematicState& state() const { return state_; }

  /// Whether the vehicle can be at `p_O`, `elapsed_s` after a sensor last saw it: inside an ellipse
  /// round the coast, along and across its direction,
  ///
  ///     along  = reach_along  + reach_along_mps2  t^2 / 2 + 2 sigma_speed t
  ///     across = reach_across + reach_across_mps2 t^2 / 2 + 2 sigma_yaw speed t
  ///
  /// each at most reach_most, with the sigmas of the state that was taken.
  [[nodiscard]] bool Reaches(const Eigen::Vector2d& p_O, double elapsed_s,
                             const BridgeConfig& config) const;

 private:
  KinematicState state_;
  Timestamp stamp_{};
  double yaw_sigma_rad_ = 0.0;
  double speed_sigma_mps_ = 0.0;
};

/// Negative evidence (empty_place): how often in a row the claimed position was in clear view and
/// nothing was there. A map that alternates between covered and clear knows little of the position,
/// so an observation that is not clear starts the run again.
///
///     log ratio = sum of ln [ (1 - (1 - clear_doubt) P_D) / (1 - false_detection) ]
///
/// Copyable, fixed size.
class EmptyPlace {
 public:
  /// An observation in clear view without a detection; counted at most once per look_s.
  void OnMiss(Timestamp stamp, double detection_probability, const BridgeConfig& config);
  void OnHit() { log_ratio_ = 0.0; }
  void OnCovered() { log_ratio_ = 0.0; }
  [[nodiscard]] double log_ratio() const { return log_ratio_; }

 private:
  double log_ratio_ = 0.0;
  std::optional<Timestamp> last_look_;
};

}  // namespace v2vouch
