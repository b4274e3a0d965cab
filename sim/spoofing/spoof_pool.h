// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/spoofing/spoof_run.h"

namespace v2vouch::evaluation {

/// F1 pooled over runs, with its 95 % interval by bootstrap over runs: 1000 draws of as many runs,
/// 2.5th and 97.5th percentile; always the same draws. Draws without a false message are passed
/// over.
struct PooledF1 {
  Confusion counts;
  std::optional<double> f1, low, high;
};

PooledF1 PoolF1(std::span<const Confusion> runs);

/// Nearest-rank percentile of times of which some are censored (never met): nothing where the rank
/// falls among these.
struct CensoredTimes {
  std::vector<double> times_s;  ///< Of those that were met.
  std::int64_t censored = 0;
  [[nodiscard]] std::int64_t count() const {
    return static_cast<std::int64_t>(times_s.size()) + censored;
  }
  /// @param share 0.5 = median.
  [[nodiscard]] std::optional<double> Percentile(double share) const;
};

/// What an attack achieved, over runs of it.
struct AttackFigures {
  int runs = 0;
  int sources = 0;  ///< Attackers with at least kSourceInView_s of false claims in joint view.
  int met = 0;
  int accused = 0;
  CensoredTimes met_after;
  PooledF1 by_message, by_source;
  std::optional<PooledF1> checks_by_message, checks_by_source;
  double exposure_max_m = 0.0;
  double exposure_p95_m = 0.0;  ///< Over the runs' largest.
  double harm_s = 0.0;          ///< Per run.
  double lingered_max_s = 0.0;  ///< Exposure::lingered_s of the worst run.
  double original_max_m = 0.0;
  int ghosts = 0;
  int ghosts_of_attackers = 0;
  std::int64_t outnumbered = 0;
  std::int64_t doubled = 0;
  HonestTreatment honest;       ///< The others, while the attack went on.
  std::vector<double> curve_m;  ///< Largest exposure over runs, per bin of time since the attack.

  [[nodiscard]] std::optional<double> withdraw_rate() const;
  [[nodiscard]] std::optional<double> accuse_rate() const;
  /// This attack's part of the composite score: 0.4 D + 0.3 exp(-TTD / 5 s) + 0.3 exp(-E / 5 m),
  /// D the withdraw rate, TTD the median time to be met (a censored one adds nothing), E the
  /// largest exposure. Nothing where no source was in view.
  [[nodiscard]] std::optional<double> score() const;
};

AttackFigures PoolAttack(std::span<const SpoofRun* const> runs);

/// Composite score, 0..100: 100 min over attacks of AttackFigures::score(), an attacker picks the
/// weakest point, x (1 - min(1, accusations per honest vehicle-hour)) x validated share.
/// Nothing where no attack could be scored or no honest time was measured.
std::optional<double> CompositeScore(std::optional<double> weakest, const HonestTreatment& honest);

}  // namespace v2vouch::evaluation
