// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "daemon/common/base/random.h"
#include "sim/attacks/ego_line.h"
#include "sim/attacks/view_timeline.h"
#include "sim/sensors/gnss_error.h"
#include "sim/sensors/message.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// What all attacks of a run look at.
struct AttackScene {
  const World& world;
  std::uint64_t seed = 0;
  const EgoLine& line;
  const ViewTimeline* views = nullptr;  ///< There when an attack needs it.
};

/// A message's place within its attack or block.
struct Moment {
  double time_s = 0.0;
  double elapsed_s = 0.0;  ///< Since this spell began.
  int number = 0;          ///< Messages of this spell before this one.
};

/// What an honest unit aboard a vehicle would say of it, but for the receiver's errors.
Statement TrueStatement(const Actor& actor, double time_s);

/// Carries a statement on by `dt_s` at its own speed, heading and yaw rate.
void CarryOn(Statement& said, double dt_s);

/// The first false version of one voice's messages: whose motion is claimed (PathSpec).
class ClaimedPath {
 public:
  /// @param victim the vehicle to shadow or to surround, an index into World::actors().
  ClaimedPath(const PathSpec& spec, const AttackScene& scene, std::optional<std::size_t> victim,
              int voice, const Random& random);

  /// Rewrites `message`, which says what the transmitter would honestly say at `now`.
  /// @return false when there is nothing to claim now.
  bool Rewrite(const Moment& now, Message& message);

 private:
  bool Ghost(const GhostSpec& spec, const Moment& now, Message& message);
  bool Shadow(const ShadowSpec& spec, const Moment& now, Message& message);
  bool Grid(const GridSpec& spec, const Moment& now, Message& message);
  bool Swap(const SwapSpec& spec, const Moment& now, Message& message);
  bool Behind(const BehindSpec& spec, const Moment& now, Message& message);
  void PlanSwap(const SwapSpec& spec, const Message& message, double from_s);
  [[nodiscard]] std::optional<std::size_t> Occluder(double time_s) const;
  [[nodiscard]] Vec2 PlaceBehind(const BehindSpec& spec, double time_s, double elapsed_s) const;

  PathSpec spec_;
  const AttackScene& scene_;
  std::optional<std::size_t> victim_;
  Random random_;
  GaussMarkov noise_east_, noise_north_;
  double last_time_s_ = 0.0;
  double began_s_ = 0.0;                 ///< When the occluder was found.
  double anchor_m_ = 0.0;                ///< Of a standing ghost along the ego's line.
  std::optional<std::size_t> occluder_;  ///< Of this spell.
  std::optional<std::size_t> other_;     ///< Whom a swap goes over to ...
  double swap_at_s_ = 0.0;               ///< ... and when.
  Vec2 cell_ = Vec2::Zero();             ///< Of a grid, along and left [m].
  double speed_scale_ = 1.0;
};

}  // namespace v2vouch::sim
