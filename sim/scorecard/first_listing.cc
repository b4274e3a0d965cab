// SPDX-License-Identifier: Apache-2.0
#include "sim/scorecard/first_listing.h"

#include <map>

namespace v2vouch::evaluation {
namespace {

constexpr double kBeside_m = 2.0;
constexpr double kLeastSeen_s = 1.0;

/// One way of being in sight.
struct Waiting {
  double seen_s = 0.0;  ///< Before the listing.
  bool was_seen = false;
};

struct Vehicle {
  Waiting moving, plain;
  bool is_listed = false;
};

void Wait(bool is_seen, bool is_listed, double period_s, Waiting& waiting) {
  if (!is_seen) return;
  waiting.was_seen = true;
  if (!is_listed) waiting.seen_s += period_s;
}

void Count(const Waiting& waiting, bool is_listed, FirstListingFigures& figures) {
  if (!waiting.was_seen) return;
  if (is_listed) {
    figures.delay_s.Add(waiting.seen_s);
  } else if (waiting.seen_s >= kLeastSeen_s) {
    ++figures.never;
  }
}

}  // namespace

FirstListings JudgeFirstListing(const RunLog& log, const std::vector<Scene>& scenes,
                                const ScorecardSettings& settings) {
  std::map<std::size_t, Vehicle> vehicles;
  for (const Scene& scene : scenes) {
    for (const SceneTruth& truth : scene.truths) {
      if (!truth.is_in_scope) continue;
      Vehicle& now = vehicles[truth.object];
      if (truth.track >= 0 && !now.is_listed) {
        const auto& track = *scene.tracks[static_cast<std::size_t>(truth.track)];
        const double error = (track.motion_B.position() - truth.motion_B.position()).norm();
        now.is_listed = error <= 0.5 * log.truth.objects[truth.object].length_m + kBeside_m;
      }
      if (truth.range_m > settings.near_m) continue;
      Wait(truth.is_moving() && truth.is_clear(), now.is_listed, settings.period_s, now.moving);
      Wait(truth.is_plain(), now.is_listed, settings.period_s, now.plain);
    }
  }
  FirstListings figures;
  for (const auto& [object, vehicle] : vehicles) {
    Count(vehicle.moving, vehicle.is_listed, figures.moving);
    Count(vehicle.plain, vehicle.is_listed, figures.plain);
  }
  return figures;
}

}  // namespace v2vouch::evaluation
