// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "sim/metrics/bound.h"
#include "sim/metrics/gospa.h"
#include "sim/metrics/placing.h"
#include "sim/metrics/sight.h"
#include "sim/metrics/tgospa.h"
#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {

/// A statistic over nothing: "none" in tables, null in JSON.
inline constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

inline double Share(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : kNoValue;
}

struct ScoringSettings {
  double cutoff_m = 10.0;
  double order = 2.0;
  double switching_m = 0.0;  ///< SP and gamma; 0 = half the cutoff.
  double radius_m = 100.0;   ///< Disc round the ego's rear axle.
  double skip_s = 1.0;       ///< At the start of the run.
  double period_s = 0.05;    ///< Of the grid.

  [[nodiscard]] double switching() const { return switching_m > 0.0 ? switching_m : cutoff_m / 2; }
};

/// 20 Hz from the first to the last truth sample.
std::vector<Timestamp> MakeGrid(const Truth& truth, const ScoringSettings& settings);

/// A true vehicle and the track matched to it at one instant.
struct MatchedPair {
  std::size_t instant = 0;
  std::size_t object = 0;  ///< Index into Truth::objects.
  std::int64_t track = 0;
  double error_m = 0.0;
  double nees = 0.0;  ///< Squared normalised position error at the list's time; NaN = unusable.
  Sighting sighting = Sighting::kVisible;  ///< By truth.
};

/// One instant of one list. All `_pow` are p-th powers.
struct InstantScore {
  double t_s = 0.0;  ///< Since the first truth sample.
  std::size_t instant = 0;
  double gospa = 0.0;
  double localisation_pow = 0.0;
  double missed_pow = 0.0;
  double false_pow = 0.0;
  double switching_pow = 0.0;
  int truths = 0;
  int missed = 0;
  int false_tracks = 0;
  double bound_gospa = 0.0;
  double bound_missed_pow = 0.0;
};

/// Averaged squared normalised error of the position; 2 is ideal. Errors of one vehicle follow each
/// other closely, so the band is that of `independent` samples (see consistency.h).
struct Anees {
  double sum = 0.0;
  std::int64_t count = 0;
  double independent = 0.0;
  double low = kNoValue;  ///< 95 % band of the mean of an honest covariance.
  double high = kNoValue;
  [[nodiscard]] double mean() const {
    return count > 0 ? sum / static_cast<double>(count) : kNoValue;
  }
  [[nodiscard]] bool is_in_band() const { return count > 0 && mean() >= low && mean() <= high; }
};

struct ListScore {
  ListKind kind = ListKind::kLocal;
  bool has_lists = false;  ///< The log holds lists of this kind.
  std::vector<InstantScore> series;
  std::vector<MatchedPair> pairs;

  // Means over instants, of roots (lengths), as the paper's table. These and all shares and ratios
  // are kNoValue where there is nothing to take them of: no list of this kind, no vehicle.
  double gospa_mean = 0.0;
  double gospa_rms = 0.0;
  double localisation_mean = 0.0;
  double missed_mean = 0.0;
  double false_mean = 0.0;
  double switching_mean = 0.0;
  double bound_mean = 0.0;
  double bound_mean_plain = 0.0;  ///< By the plain rule, see BoundCell.
  double bound_missed_mean = 0.0;

  double switch_halves = 0.0;  ///< Sum of the half-counted switches behind switching_mean.
  int switches = 0;            ///< Vehicles followed by another track than the last, gaps included.
  std::int64_t false_instants = 0;  ///< False tracks summed over instants.
  int false_track_ids = 0;          ///< Distinct tracks that were false at some instant.
  double vehicle_seconds = 0.0;
  double missed_seconds = 0.0;
  double bound_missed_seconds = 0.0;
  double excess_missed_seconds = 0.0;        ///< Missed while the bound holds the vehicle.
  double excess_missed_share = 0.0;          ///< Of the vehicle-seconds the bound holds.
  double excess_missed_visible_share = 0.0;  ///< The same while a sensor's ray reaches the vehicle.
  double excess_missed_share_plain = 0.0;    ///< The same for the plain bound.
  double localisation_rms_m = 0.0;           ///< Visible vehicles only (V2V: all).
  double localisation_ratio = 0.0;           ///< Over the bound's RMS for the same pairs.
  /// LOCAL: over the bound's RMS for extended vehicles of unknown size, same pairs.
  double localisation_extended_ratio = kNoValue;
  double localisation_all_rms_m = 0.0;
  Anees visible, hidden, out_of_view;  ///< By the vehicle's true sighting.
  TrajectoryGospaResult trajectory;
  double trajectory_per_step = kNoValue;  ///< (power / instants)^(1/p).

  [[nodiscard]] double ratio() const {
    return bound_mean > 0.0 ? gospa_mean / bound_mean : kNoValue;
  }
  [[nodiscard]] double false_per_instant() const {
    return series.empty() || !has_lists
               ? kNoValue
               : static_cast<double>(false_instants) / static_cast<double>(series.size());
  }
};

/// Scores one list of a run.
///
/// At each instant of the grid: the newest list received by then (stale copies too, as a consumer
/// would), its body-frame states put into the world with the true ego pose at the list's time and
/// carried to the instant with Predict(); footprint centres matched to all truths in scope; then
/// pairs whose truth is outside the disc, truths outside and lone tracks outside are dropped.
/// LOCAL's pedestrian and cyclist tracks are not scored, nor is a LOCAL track left over beside a
/// true pedestrian or cyclist counted as false.
ListScore ScoreList(const RunLog& log, const std::vector<Timestamp>& grid, const Bound& bound,
                    ListKind kind, Against against, const ScoringSettings& settings,
                    bool with_trajectories);

}  // namespace v2vouch::evaluation
