// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/attacks/claimed_path.h"
#include "sim/world/attack_spec.h"

namespace v2vouch::sim {

/// Whether an attack asks for a ViewTimeline, which takes a while to make.
bool NeedsViews(const AttackSpec& attack);

/// The vehicles that `who` means, indices into World::actors(), in order of id. Of a share: so
/// many, rounded, one at least, by an order drawn from the seed alone.
std::vector<std::size_t> ChooseAttackers(const WhoSpec& who, const AttackScene& scene);

/// The vehicle a shadow follows or a grid surrounds, one that drives; ties go to the lower id.
/// @return nullopt with a note when there is none, or when the path needs none.
std::optional<std::size_t> ChooseVictim(const AttackSpec& attack, const AttackScene& scene,
                                        std::vector<std::string>& notes);

}  // namespace v2vouch::sim
