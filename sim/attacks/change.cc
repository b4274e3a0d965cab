// SPDX-License-Identifier: Apache-2.0
#include "sim/attacks/change.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::sim {

Change::Change(const ChangeSpec& spec, const AttackScene& scene, const Speaker& speaker,
               const Random& random)
    : spec_(spec), scene_(scene), speaker_(speaker), random_(random), gate_(spec.when) {}

void Change::Pass(const Circumstances& now, Message& message) {
  if (spec_.rate) return;  // Times has asked the gate.
  Remember(message);
  if (!gate_.Update(now)) return;
  acts_ = true;
  const Moment moment{now.time_s, gate_.elapsed_s(), gate_.number()};
  const auto alter = [&](const auto&... blocks) {
    ((blocks ? Alter(*blocks, moment, message) : void()), ...);
  };
  alter(spec_.offset, spec_.drift, spec_.brake, spec_.freeze, spec_.eventual_stop, spec_.speed,
        spec_.heading, spec_.acceleration, spec_.size, spec_.accuracy, spec_.mirror, spec_.rotate,
        spec_.delay, spec_.replay, spec_.identity, spec_.impersonate);
  message.is_attack = message.is_attack || acts_;
}

bool Change::IsToBeDrawn(Draw draw) {
  const bool is_due = draw == Draw::kPerMessage || !has_drawn_;
  has_drawn_ = true;
  return is_due;
}

void Change::Watch(const Message& message) { Remember(message); }

int Change::Times(const Circumstances& now) {
  if (!spec_.rate || !gate_.Update(now)) return 1;
  return static_cast<int>(std::lround(spec_.rate->times));
}

}  // namespace v2vouch::sim
