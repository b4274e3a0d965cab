// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sim/spoofing/message_judgement.h"

namespace v2vouch::evaluation {

/// A PRIORITY track where nothing real is.
struct Ghost {
  std::int64_t track = 0;
  std::uint32_t sender = 0;
  bool is_of_attacker = false;  ///< At any time.
  double from_s = 0.0;          ///< Since the first truth sample.
  double to_s = 0.0;            ///< The last instant; a track may come back in between.
  double max_m = 0.0;           ///< Largest exposure.
};

/// What an attack makes a consumer of PRIORITY believe, on a 20 Hz grid: the newest list received
/// by each instant, predicted to it.
///
/// The exposure of a track is the distance from its centre to the nearest real vehicle's box, 0
/// inside. Tracks whose sender is an attacker, from that id's first attack message on, count for
/// the attack; ghosts and crowding count whoever sends. TRUTH reaches to 150 m from the ego, so
/// tracks further away than `kReach_m` are left out: what is real beside them is not known.
struct Exposure {
  static constexpr double kHarm_m = 3.0;
  static constexpr double kLinger_m = 2.0;
  static constexpr double kGhost_m = 5.0;
  static constexpr double kGhost_s = 0.2;
  static constexpr double kBin_s = 0.5;
  static constexpr double kReach_m = 140.0;

  double max_m = 0.0;
  double harm_s = 0.0;  ///< Track-seconds with an exposure above `kHarm_m`.
  /// The same distance to the vehicle the device first spoke for (its own, or the one it shadows).
  double original_max_m = 0.0;
  double original_harm_s = 0.0;
  /// Longest time on end that such a track was more than `kLinger_m` from every real vehicle's box
  /// while its place was in joint view: what the sensors could have seen to be empty.
  double lingered_s = 0.0;
  double priority_s = 0.0;  ///< Track-seconds of attackers in PRIORITY after their attack began.
  /// Largest exposure per bin of time since the first attack message of the run.
  std::vector<double> curve_m;

  std::vector<Ghost>
      ghosts;  ///< Tracks above `kGhost_m` for at least `kGhost_s` on end, once each.
  std::int64_t instants = 0;
  std::int64_t outnumbered = 0;  ///< Instants with more PRIORITY tracks than real vehicles.
  /// Instants with two PRIORITY tracks within 1 m of the same real vehicle and none other within
  /// 3 m of either: one car listed twice.
  std::int64_t doubled = 0;

  [[nodiscard]] int ghosts_of_attackers() const;
};

Exposure MeasureExposure(const RunLog& log, const Senders& senders);

}  // namespace v2vouch::evaluation
