// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace v2vouch::evaluation {

/// A small left-turn run with lists made by hand, so that evaluation can be tested without the
/// estimator. 14 s; the ego (truth and lists alike) comes to a stop at the junction.
///
///     1  car, V2V       oncoming; seen, hidden from 4 s to 8 s, seen again
///     2  truck          standing in the opposing turn lane
///     3  car, V2V       turns off in front; hidden from 9 s
///     4  car            parked
///     5  car, V2V       behind, never seen
///     6  pedestrian
///
/// LOCAL and PRIORITY follow what is visible with noise; LOCAL loses 1 while it is hidden and finds
/// it again under a new id; PRIORITY keeps it on V2V; V2V carries everybody who sends, off by a
/// constant bias. LOCAL has one false track for half a second.
struct SyntheticRun {
  double noise_sigma_m = 0.15;    ///< Per axis, of listed visible positions.
  double bias_m = 1.2;            ///< Of the V2V list, eastwards.
  double latency_s = 0.03;        ///< From a list's time to its arrival.
  double recorder_ahead_s = 0.0;  ///< Of the message clock; the log's own stamps only.
  bool has_truth = true;
  bool has_lists = true;
  bool paper_like = false;  ///< PRIORITY as the paper's method makes it: with a ghost, no bridging.
  std::uint64_t seed = 1;

  static constexpr double kHiddenFrom_s = 4.0;
  static constexpr double kHiddenTo_s = 8.0;
  static constexpr double kLength_s = 14.0;

  /// Writes the log. @return false when the file cannot be written.
  [[nodiscard]] bool Write(const std::string& path) const;
};

}  // namespace v2vouch::evaluation
