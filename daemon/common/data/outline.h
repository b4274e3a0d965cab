// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "daemon/common/data/measurement.h"

namespace v2vouch {

/// Leaves of a vehicle's reflections those that mark its outline, strongest first: within 10 dB of
/// the strongest, and with none of these clearly nearer to the radar at the same bearing.
/// @return how many are left, at the front of `returns`.
std::size_t KeepOutline(std::span<OutlineReturn> returns);

}  // namespace v2vouch
