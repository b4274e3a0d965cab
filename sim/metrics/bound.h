// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {

/// What the best possible list could know of one true vehicle at one instant.
struct BoundCell {
  bool is_held = false;  ///< Could be in the list.
  /// By the plain rule: LOCAL from the second look of any sensor, PRIORITY without validation time.
  bool is_held_plain = false;
  double variance_m2 = 0.0;  ///< E |position error|^2 of an unbiased estimate; where held.
  /// LOCAL: the same for a vehicle of unknown size, by ExtendedFilter.
  double extended_variance_m2 = 0.0;
};

struct BoundSettings {
  double drop_cutoff_m = 10.0;    ///< c of the rule below, for every c reported.
  double validation_s = 1.5;      ///< PRIORITY: counted from max(first BSM, sensor confirmation).
  double looks_to_confirm = 1.5;  ///< Sum of detection probabilities: passed in the second look.
  double moving_mps = 1.0;        ///< From here on a radar alone may start a LOCAL track.
  double singer_time_s = 1.5;
  double least_along_mps2 = 0.5;  ///< Floors of the realised accelerations: quiet driving.
  double least_across_mps2 = 0.3;
  double bridge_most_s = 10.0;  ///< PRIORITY's budget: min(most, max(least, base + co-observed)).
  double bridge_base_s = 2.0;
  double bridge_least_s = 4.5;
  bool only_senders = false;  ///< Leave the cells of vehicles that send no BSMs empty.
};

/// The posterior Cramer-Rao bound of a run, by information recursion along every true vehicle's
/// own path, at every instant of a grid:
///
///     J <- (F J^-1 F' + Q)^-1 + sum over looks P_D H' R^-1 H
///
/// Motion: Singer, time constant 1.5 s, with that vehicle's own root mean square accelerations
/// along and across its heading over the run (not below the floors). Measurements: every own-sensor
/// frame that reached the log, with its true detection probability from TRUTH (0 where hidden), the
/// scenario's sigmas for one reflection, one reflection per look, reference point known, ego pose
/// exact; a frame's age at arrival is neglected. So for extended cars this is the bound of point
/// targets with the reflections' noise; beside it stands that of extended vehicles of unknown size
/// (extended_filter.h). PRIORITY adds the BSMs that arrived: position with constant
/// and Gauss-Markov bias states, speed and heading with error states, acceleration and yaw rate;
/// V2V has these alone.
///
/// When could a vehicle be in the list? LOCAL: from its second look that may start a track (any
/// camera's; a radar's while it moves: a standing return alone may be a post and starts none) until
/// hiding has made its expected truncated squared error exceed c^2/2 at c = 10 (where the existence
/// threshold c^2 / (2 (c^2 - D)) passes 1), then again from such a look. PRIORITY: from
/// max(first BSM, sensor confirmation) + 1.5 s while the bridging budget lasts. V2V: from the
/// second BSM, until D passes c^2/2.
/// Sources: Tichavsky, Muravchik, Nehorai, "Posterior Cramer-Rao bounds for discrete-time nonlinear
/// filtering", IEEE TSP 1998; detection probability as a scale on information: Zhang and Willett,
/// 2001 (information reduction); Singer, IEEE TAES 1970.
class Bound {
 public:
  Bound(const RunLog& log, const std::vector<Timestamp>& grid, const BoundSettings& settings = {});

  /// @param object index into Truth::objects; @param instant index into the grid.
  [[nodiscard]] const BoundCell& At(ListKind kind, std::size_t object, std::size_t instant) const {
    return cells_[Index(kind)][object * instants_ + instant];
  }

 private:
  std::size_t instants_;
  std::array<std::vector<BoundCell>, 3> cells_;
};

/// E min(d^2, c^2) for a planar error with E d^2 = `variance_m2`, taken as isotropic and normal:
/// m (1 - exp(-c^2 / m)).
inline double TruncatedSquare(double variance_m2, double cutoff_m) {
  if (variance_m2 <= 0.0) return 0.0;
  return -variance_m2 * std::expm1(-cutoff_m * cutoff_m / variance_m2);
}

}  // namespace v2vouch::evaluation
