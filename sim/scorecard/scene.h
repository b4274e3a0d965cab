// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sim/metrics/footprint.h"
#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {

struct ScorecardSettings {
  double cutoff_m = 10.0;   ///< A pair this far apart is one missed and one false.
  double radius_m = 100.0;  ///< Disc round the ego's rear axle: false entries, identities.
  double near_m = 60.0;     ///< Errors, missed, first listing: vehicles within this of it.
  double skip_s = 1.0;      ///< At the start of the run.
  double period_s = 0.1;    ///< One list in this time is scored.
};

/// A true road user at the time of a list, in the ego's body frame B then.
struct SceneTruth {
  std::size_t object = 0;  ///< Index into Truth::objects.
  PlanarMotion motion_B;   ///< Speed over ground.
  Footprint box_B;
  double range_m = 0.0;  ///< From the ego's rear axle to its centre.
  bool is_hidden = false;
  bool is_vehicle = true;
  bool is_in_scope = true;    ///< Of this list: every vehicle, or those that send BSMs.
  double radar_sight = 0.0;   ///< Largest uncovered share over the radars; 0 where hidden.
  double camera_sight = 0.0;  ///< ... over the cameras.
  int track = -1;             ///< Index into the scene's tracks.

  static constexpr double kVisible = 0.25, kClear = 0.7, kPlain = 0.9;
  [[nodiscard]] double sight() const { return std::max(radar_sight, camera_sight); }
  /// A quarter of it or more in sight of an own sensor. What shows less counts neither way.
  [[nodiscard]] bool is_visible() const { return sight() >= kVisible; }
  [[nodiscard]] bool is_clear() const { return sight() >= kClear; }
  /// Nearly whole in sight of a radar and of a camera.
  [[nodiscard]] bool is_plain() const { return std::min(radar_sight, camera_sight) >= kPlain; }
  [[nodiscard]] bool is_moving() const { return std::abs(motion_B.speed_mps) >= 0.5; }
};

/// One scored instant of one list.
struct Scene {
  Timestamp stamp{};
  double t_s = 0.0;                    ///< Since the first truth sample.
  bool is_scored = false;              ///< False in the first `skip_s`.
  PlanarMotion ego_W;                  ///< Rear axle.
  const ReceivedList* list = nullptr;  ///< Null: nothing was published in time.
  std::vector<SceneTruth> truths;
  std::vector<const ListedTrack*> tracks;  ///< LOCAL: without pedestrians and cyclists.
  std::vector<int> owner;  ///< Per track the index into `truths` it is matched to, or -1.
};

/// Every `period_s` from the first truth sample on: the newest list by its own stamp, in its last
/// correction (the last message of that stamp), and the truth at that stamp; vehicles in scope
/// matched to tracks by GOSPA's assignment at the cutoff. Where the newest list is older than 1.5
/// periods, nothing is published.
///
/// A vehicle's uncovered share is TRUTH's own for sensors that have a detection probability; in a
/// log without those it is UncoveredShares() of the true boxes, seen from each own sensor whose
/// field of view and range hold the vehicle's centre.
std::vector<Scene> MakeScenes(const RunLog& log, ListKind kind, const ScorecardSettings& settings);

}  // namespace v2vouch::evaluation
