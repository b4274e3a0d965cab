// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "daemon/common/base/time.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/track.h"
#include "daemon/v2v/priority/bridge.h"
#include "daemon/v2v/priority/priority_filter.h"

namespace v2vouch {

/// One vehicle of the PRIORITY list: its fused filter, what the sensors last said of it, and what
/// is left of its bridge. It belongs to the physical vehicle; the sender is the identity that
/// speaks for it now. Copyable, fixed size.
struct PriorityVehicle {
  std::uint64_t id = 0;        ///< Of PRIORITY; see PriorityId(). 0: it has ended.
  std::uint64_t local_id = 0;  ///< The LOCAL track it rests on; 0 = none.
  /// ... and that it rested on last; LOCAL may list it again.
  std::uint64_t former_local_id = 0;
  SenderId sender = 0;
  std::optional<SenderId> predecessor{};  ///< Identity it spoke under before ...
  Timestamp handover{};                   ///< ... until then.
  Timestamp start{};
  PriorityFilter filter;
  Coast coast{};   ///< LOCAL at the last sensor support.
  Coast agreed{};  ///< The fused state then: what sensors and sender agreed upon.

  /// Doubt of the position beside the filter's: what LOCAL had more when it was last seen. It is
  /// published, but the filter does not follow it.
  Eigen::Matrix2d lasting = Eigen::Matrix2d::Zero();
  double lasting_variance_m2 = 0.0;  ///< LocalTrack's, from its last support.

  bool is_supported = true;  ///< Sensors see it; false: bridged.
  Timestamp last_support{};
  int regained_hits = 0;           ///< Hits since support was lost.
  std::uint64_t regaining_id = 0;  ///< LOCAL track that may be it come back; 0 = none.
  Timestamp last_regain{};         ///< Of the last such hit.
  int elsewhere_hits = 0;          ///< Hits in a row of a track that contradicts the bridge.
  std::uint64_t elsewhere_id = 0;  ///< That track; 0 = none.
  Timestamp last_elsewhere{};      ///< Of the last such hit.
  double co_observed_s = 0.0;      ///< Sensors and sender together.

  Timestamp last_v2v{};
  int misfits_in_a_row = 0;  ///< Claims that did not fit the filter.
  int velocity_doubts = 0;   ///< In this bridge; see PriorityFilter::DoubtVelocity().
  EmptyPlace empty{};

  Extent extent{};
  ObjectClass object_class = ObjectClass::kUnknown;
  double existence = 1.0;
  Visibility visibility = Visibility::kVisible;
  SensorSupport support{};
  TrackEvents events = 0;  ///< As its sender last reported.

  [[nodiscard]] bool has_ended() const { return id == 0; }

  /// Carries filter and coast to `stamp`; nothing where it lies behind them.
  void PredictTo(Timestamp stamp, const PriorityFilterConfig& config);
  /// The vehicle at `at`, a copy; a little before the filter's own time is allowed.
  [[nodiscard]] KinematicState StateAt(Timestamp at, const PriorityFilterConfig& config) const;

  /// Whether it can be at `p_O` at `now` by what was known when the sensors lost it. A vehicle that
  /// slips behind something is measured by ever smaller parts, which drag LOCAL's direction by 15
  /// to 30 degrees; a fused state that the sender has led astray is the other danger. So either
  /// coast will do: the one is out of the sender's reach, the other differed from LOCAL by no more
  /// than the trust checks allow.
  [[nodiscard]] bool CanReach(const Eigen::Vector2d& p_O, Timestamp now,
                              const BridgeConfig& config) const;

  /// Seconds for which V2V may still keep it alive at `now`.
  [[nodiscard]] double BudgetLeft_s(Timestamp now, const BridgeConfig& config) const {
    const double budget_s = BridgeBudget_s(co_observed_s, config);
    return is_supported ? budget_s : budget_s - ToSeconds(now - last_support);
  }
};

/// PRIORITY's own id for a vehicle validated on a LOCAL track: a function of that track alone
/// (mixed as by splitmix64, Steele et al. 2014), positive in 63 bits. `attempt` > 0 gives another
/// where a vehicle that has moved on to a new LOCAL track still holds the first.
std::uint64_t PriorityId(std::uint64_t local_id, int attempt);

}  // namespace v2vouch
