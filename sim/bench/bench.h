// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "sim/bench/traffic.h"

namespace v2vouch::bench {

/// What the tracker is told about the detections, and how its tracks are judged.
struct BenchSettings {
  PoseNoise noise{};
  double detection_probability = 0.95;
  double clutter_share = 0.05;      ///< Of the detections.
  double confirm_existence = 0.99;  ///< A track counts from here on.
  double gate_probability = 0.9999;
  double cutoff_m = 5.0;  ///< GOSPA's c; p = 2, alpha = 2.
  int skipped_frames = 20;
};

/// Figures over all frames but the first ones. GOSPA, misses and false tracks count an instant's
/// confirmed tracks against its truth, after the frame's own detections.
struct BenchFigures {
  int frames = 0;  ///< Scored.
  std::int64_t truths = 0;
  std::int64_t detections = 0;
  double gospa_sum = 0.0;
  double square_error_m2 = 0.0;  ///< Over assigned pairs, both axes together.
  std::int64_t assigned = 0;
  std::int64_t missed = 0;        ///< Truths without a confirmed track within the cut-off.
  std::int64_t false_states = 0;  ///< Confirmed tracks unassigned at the cut-off, summed.
  int false_tracks = 0;           ///< How many tracks were so at any time.
  int switches = 0;               ///< A truth held by another track than the last that held it.
  std::vector<double> step_ms;    ///< Predict + associate + update of every frame, none skipped.

  // NaN where there is nothing to take them of.
  [[nodiscard]] double gospa_mean() const;
  [[nodiscard]] double rmse_m() const;
  [[nodiscard]] double ms_mean() const;
  [[nodiscard]] double ms_quantile(double share) const;
  /// Takes over another recording's figures.
  void Add(const BenchFigures& other);
};

/// The tracks confirmed at one instant, for tests that compare runs.
struct Snapshot {
  std::vector<std::uint64_t> ids;
  std::vector<int> poses;  ///< Per track the detection it was given, or -1.
};

/// Seconds of any clock that does not go back.
using Stopwatch = std::function<double()>;

/// Runs the tracker core (Tracker::UpdatePoses) over a recording: its default motion noise, point
/// targets, and for the density of clutter what the frame itself says, taking clutter to look like
/// everything else in it:
///
///     clutter_share x detections / (area x yaw span x speed span x yaw-rate span),
///     area = 12 sqrt(det(covariance of positions)),   span = sqrt(12 variance), of yaw for both
///     ways of the road
///
/// which is exact for a filled rectangle and uniform values, and does not know how the road lies.
/// @param watch times the steps; absent: all times are 0.
/// @param snapshots one per frame, where wanted.
BenchFigures RunBench(const Recording& recording, const BenchSettings& settings,
                      const Stopwatch& watch = {}, std::vector<Snapshot>* snapshots = nullptr);

}  // namespace v2vouch::bench
