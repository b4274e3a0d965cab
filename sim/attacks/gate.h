// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sim/attacks/view_timeline.h"
#include "sim/world/attack_change_spec.h"

namespace v2vouch::sim {

/// What a gate is asked about.
struct Circumstances {
  double time_s = 0.0;
  double since_attack_s = 0.0;  ///< Since the attack's spell began ...
  int attack_spell = 0;         ///< ... and which one it is; with a new one blocks begin anew.
  double ego_speed_mps = 0.0;
  std::optional<std::size_t> actor;     ///< The vehicle spoken for, an index into World::actors().
  const ViewTimeline* views = nullptr;  ///< There when a gate needs it.
};

/// Whether an attack or a block is at work (WhenSpec), asked once per message in order of time.
class Gate {
 public:
  explicit Gate(const WhenSpec& when) : when_(when) {}

  /// @return whether it is at work now; the two below then tell of this spell.
  bool Update(const Circumstances& now);

  [[nodiscard]] double elapsed_s() const { return elapsed_s_; }
  [[nodiscard]] int number() const { return number_; }  ///< Messages before this one.
  [[nodiscard]] int spell() const { return spell_; }

  /// Whether the spec asks for a ViewTimeline.
  static bool NeedsViews(const WhenSpec& when) {
    return when.after_in_view_s > 0.0 || when.after_hidden_s > 0.0;
  }

 private:
  [[nodiscard]] bool Begins(const Circumstances& now) const;

  WhenSpec when_;
  std::optional<double> began_s_;
  int spell_ = -1;
  int attack_spell_ = 0;
  double elapsed_s_ = 0.0;
  int number_ = 0;
};

}  // namespace v2vouch::sim
