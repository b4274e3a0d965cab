// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "daemon/common/base/reason.h"
#include "sim/simulation/simulation.h"

namespace v2vouch::testing {

using Recording = std::vector<sim::SimEvent>;

/// A shipped scenario as it arrives at the car; empty and a test failure when it cannot be run.
Recording Record(const std::string& scenario, std::uint64_t seed);
/// With a shipped overlay laid over it (a file of sim/attacks/catalogue, without ending) and so
/// many vehicles of traffic.
Recording RecordWith(const std::string& scenario, std::uint64_t seed, const std::string& overlay,
                     int vehicles);

/// What the core made of a recording.
struct Outcome {
  std::string digest_local;
  std::string digest_priority;
  ReasonCounts refused{};
  std::int64_t local_tracks = 0;     ///< Lines of TRACKS_LOCAL, all lists together.
  std::int64_t priority_tracks = 0;  ///< The same for TRACKS_PRIORITY.
  std::int64_t not_finite = 0;       ///< Lines with a NaN or infinity in state or covariance.
  std::set<std::uint32_t> vouched;   ///< TemporaryIDs ever listed in TRACKS_PRIORITY.
  std::map<std::uint32_t, std::set<std::int64_t>> priority_ids;  ///< Of each of those.
  std::vector<std::string> reports;  ///< Checks of MISBEHAVIOR, in order.
  /// Of vehicles in TRACKS_PRIORITY that rest on no LOCAL track: squared distance to the nearest
  /// vehicle of TRUTH [m^2], summed, and how many.
  double hidden_error_m2 = 0.0;
  int hidden_entries = 0;
};

Outcome Perceive(const Recording& recording, const std::string& config_path = "");

/// Without one channel.
Recording Without(const Recording& recording, const std::string& channel);

/// The ego's GNSS lies `north_m` to the north from `from_s` after the start on.
Recording WithGnssJump(const Recording& recording, double from_s, double north_m);

/// One sender more, which no sensor can ever see: every 0.1 s it claims the place that `where`
/// gives relative to the ego's rear axle (x ahead, y left), with the ego's speed and course,
/// wherever no true vehicle is within 8 m.
struct Ghost {
  std::uint32_t id = 0;
  std::function<std::pair<double, double>(double t_s)> where;
};
Recording WithGhosts(const Recording& recording, const std::vector<Ghost>& ghosts);

}  // namespace v2vouch::testing
