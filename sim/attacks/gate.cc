// SPDX-License-Identifier: Apache-2.0
#include "sim/attacks/gate.h"

#include <cmath>

namespace v2vouch::sim {

bool Gate::Begins(const Circumstances& now) const {
  if (now.time_s < when_.start_s || now.since_attack_s < when_.after_s) return false;
  if (when_.ego_above_mps > 0.0 && now.ego_speed_mps <= when_.ego_above_mps) return false;
  if (!NeedsViews(when_)) return true;
  if (!now.actor || now.views == nullptr) return false;
  if (when_.after_hidden_s > 0.0) {
    return now.views->HiddenFor(*now.actor, now.time_s) >= when_.after_hidden_s &&
           now.views->LastViewFor(*now.actor, now.time_s) >= when_.after_in_view_s;
  }
  return now.views->InViewFor(*now.actor, now.time_s) >= when_.after_in_view_s;
}

bool Gate::Update(const Circumstances& now) {
  if (now.attack_spell != attack_spell_) {
    began_s_.reset();
    spell_ = -1;
    attack_spell_ = now.attack_spell;
  }
  if (!began_s_ && Begins(now)) began_s_ = now.time_s;
  if (!began_s_ || (when_.stop_s > 0.0 && now.time_s >= when_.stop_s)) return false;
  const double since = now.time_s - *began_s_;
  const double cycle = when_.active_s + when_.pause_s;
  const int spell = cycle > 0.0 ? static_cast<int>(std::floor(since / cycle)) : 0;
  const double elapsed = since - spell * cycle;
  if (cycle > 0.0 && elapsed >= when_.active_s) return false;
  number_ = spell == spell_ ? number_ + 1 : 0;
  spell_ = spell;
  elapsed_s_ = elapsed;
  return true;
}

}  // namespace v2vouch::sim
